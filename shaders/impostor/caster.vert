// Caster tiles, one instance each, on the plane through the object's centre. They put objects whose
// mesh is not present into a shadow map. World axes, positions relative to the map's centre.
layout(location = 0) in vec2 a_corner;
layout(location = 1) in vec4 i_center_scale;
layout(location = 2) in vec4 i_right_distance;  // capture right, distance Dc in object units
layout(location = 3) in vec4 i_up_near;         // capture up, depth of code 1
layout(location = 4) in vec4 i_window;          // crop as tangents: left, top, right, bottom
layout(location = 5) in vec4 i_atlas;           // first texel of the crop, its size
layout(location = 6) in vec4 i_far_layer;       // depth of code 255, layer

uniform mat4 u_clip_from_relative;

precise out vec2 v_texel;
precise out vec2 v_tangent;
precise flat out vec4 v_center_scale;
precise flat out vec4 v_right_distance;
precise flat out vec4 v_up_near;
precise flat out vec2 v_far_layer;

PRECISE_BUILT_IN(gl_Position)

void main() {
  v_texel = i_atlas.xy + a_corner * i_atlas.zw;
  v_tangent = mix(i_window.xy, i_window.zw, a_corner);
  v_center_scale = i_center_scale;
  v_right_distance = i_right_distance;
  v_up_near = i_up_near;
  v_far_layer = i_far_layer.xy;
  vec3 on_plane = (i_right_distance.xyz * v_tangent.x + i_up_near.xyz * v_tangent.y) * i_right_distance.w;
  gl_Position = u_clip_from_relative * vec4(i_center_scale.xyz + i_center_scale.w * on_plane, 1.0);
}

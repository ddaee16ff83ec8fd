// Impostors, one instance each. The proxy is built around the object's centre in object space:
//   PROXY_QUAD   the crop window on the plane at the tile's own depth (TECHNIQUES rows 12, 24)
//   PROXY_CUBOID the bounding box (row 13)          PROXY_HULL  the convex hull (rows 14, 15)
layout(location = 0) in vec3 a_position;  // quad: corner 0..1; cuboid: 0..1; hull: object space
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 i_rotation;        // world_from_object, xyzw
layout(location = 3) in vec4 i_center_scale;    // centre relative to the eye, uniform scale
layout(location = 4) in vec4 i_right_distance;  // capture right, distance Dc
layout(location = 5) in vec4 i_up_plane;        // capture up, plane depth of the quad
layout(location = 6) in vec4 i_window;          // crop as tangents: left, top, right, bottom
layout(location = 7) in vec4 i_atlas;           // first texel of the crop, texels per tangent
layout(location = 8) in vec4 i_depth;           // near, far, layer, fade
layout(location = 9) in vec4 i_box_min;         // object space; w: depth bias
layout(location = 10) in vec4 i_box_max;        // w: coarseness of the stored depth, object units
// of the bounding sphere, object space; w: least capture depth
layout(location = 11) in vec4 i_center;
#ifdef METHOD_WARP
layout(location = 12) in float a_parallax;      // distance from the proxy to the mesh behind it
precise out float v_parallax;
precise flat out vec2 v_range;  // capture depths of the content
#endif

uniform mat4 u_clip_from_relative;
uniform vec3 u_forward;  // camera, world

#include "common/rotation.glsl"
#ifdef SHADOW
#include "impostor/worn_shadow_vertex.glsl"
#endif

precise out vec3 v_point;             // on the proxy, object space relative to the centre
precise flat out vec3 v_eye;          // present eye, in the same space
precise flat out vec3 v_right;
precise flat out vec3 v_up;
precise flat out vec3 v_ahead;        // capture forward
precise flat out vec4 v_window;
precise flat out vec4 v_atlas;
precise flat out vec4 v_depth;
precise flat out vec4 v_capture;      // Dc, plane depth, depth bias, view depth of the centre
precise flat out vec3 v_view_depth;   // view depth = v_capture.w + dot(v_view_depth, point)
precise flat out vec3 v_box_min;
precise flat out vec3 v_box_max;
precise flat out float v_depth_slack;  // view depth by which stored depth may be too far
precise flat out vec3 v_normal;
#if defined(RELIT) || defined(FOG)
precise flat out vec4 v_rotation;
precise flat out vec4 v_center_scale;
#endif

vec4 conjugate(vec4 q) { return vec4(-q.xyz, q.w); }

PRECISE_BUILT_IN(gl_Position)

void main() {
#ifdef SHADOW
  wear_shadow();
#endif
  v_right = i_right_distance.xyz;
  v_up = i_up_plane.xyz;
  v_ahead = -cross(v_right, v_up);
  float distance = i_right_distance.w, plane = i_up_plane.w, scale = i_center_scale.w;
#ifdef PROXY_QUAD
  vec2 grow = (i_window.zw - i_window.xy) * QUAD_MARGIN;
  vec2 t = mix(i_window.xy - grow, i_window.zw + grow, a_position.xy);
  v_point = (v_right * t.x + v_up * t.y) * plane + v_ahead * (plane - distance);
#else
#ifdef PROXY_CUBOID
  v_point = mix(i_box_min.xyz, i_box_max.xyz, a_position) - i_center.xyz;
#else
  v_point = a_position - i_center.xyz;
#endif
#endif
  v_normal = a_normal;
#if defined(RELIT) || defined(FOG)
  v_rotation = i_rotation;
  v_center_scale = i_center_scale;
#endif
#ifdef METHOD_WARP
  v_parallax = a_parallax;
  // The plane is at the harmonic mean of the range (tile_measure.cpp).
  v_range = vec2(i_center.w, 1.0 / max(2.0 / plane - 1.0 / i_center.w, 1e-9));
#endif
  vec4 inverse = conjugate(i_rotation);
  v_eye = rotate(inverse, -i_center_scale.xyz) / scale;
  v_window = i_window;
  v_atlas = i_atlas;
  v_depth = i_depth;
  v_capture = vec4(distance, plane, i_box_min.w, dot(i_center_scale.xyz, u_forward));
  v_view_depth = rotate(inverse, u_forward) * scale;
  v_depth_slack = i_box_max.w * scale;
  v_box_min = i_box_min.xyz - i_center.xyz;
  v_box_max = i_box_max.xyz - i_center.xyz;
  vec3 relative = i_center_scale.xyz + rotate(i_rotation, scale * v_point);
  gl_Position = u_clip_from_relative * vec4(relative, 1.0);
}

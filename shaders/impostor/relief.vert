// Impostors drawn by tracing the stored depth (TECHNIQUES row 16). The proxy is the part of the
// capture frustum that holds the tile's content, so near the capture pose a ray crosses few texels.
// Its far faces are drawn: each pixel once, also with the eye inside.
//
// Tile space: x, y in atlas texels, third axis the depth code 0..254. The code is linear in 1 /
// depth, so a ray is a straight line there, and a point's place is linear in homogeneous
// coordinates.
layout(location = 0) in vec3 a_position;        // 0..1
layout(location = 2) in vec4 i_rotation;        // world_from_object, xyzw
layout(location = 3) in vec4 i_center_scale;    // centre relative to the eye, uniform scale
layout(location = 4) in vec4 i_right_distance;  // capture right, distance Dc
layout(location = 5) in vec4 i_up_texels;       // capture up, texels per tangent
layout(location = 6) in vec4 i_window;          // crop as tangents: left, top, right, bottom
layout(location = 7) in vec4 i_place;           // first texel of the crop, layer, fade
layout(location = 8) in vec4 i_range;           // depth of code 0 and 254, least and largest code
layout(location = 9) in vec4 i_slack;           // depth bias, coarseness of depth in object units
#ifdef LAYERED
layout(location = 10) in vec4 i_front;   // from the tile's place to the front's colours: texels, layer
layout(location = 11) in vec4 i_behind;  // and to the layer behind
precise flat out vec3 v_front;
precise flat out vec3 v_behind;
#endif

uniform mat4 u_clip_from_relative;

#include "common/rotation.glsl"
#ifdef SHADOW
#include "impostor/worn_shadow_vertex.glsl"
precise flat out vec4 v_center_scale;
#endif

precise flat out vec4 v_slack;  // depth bias, view depth by which stored depth may be too far, fade
precise out vec4 v_tile;        // the proxy's point in homogeneous tile space
precise flat out vec4 v_eye;    // the eye in it
precise flat out vec4 v_low_layer;
precise flat out vec4 v_high;
#ifdef RELIT
precise flat out vec3 v_right;  // capture basis, also the next
precise flat out vec3 v_up;
precise flat out vec4 v_rotation;
#endif
precise out vec3 v_relative;    // the proxy's point relative to the eye, world

PRECISE_BUILT_IN(gl_Position)

void main() {
#ifdef SHADOW
  wear_shadow();
  v_center_scale = i_center_scale;
#endif
  vec3 right = i_right_distance.xyz, up = i_up_texels.xyz;
  vec3 ahead = -cross(right, up);
  float scale = i_center_scale.w;
  v_slack = vec4(i_slack.x, i_slack.y * scale, i_place.w, 0.0);
  float near = i_range.x, far = i_range.y, texels = i_up_texels.w;
  // The cube's third axis points towards the eye, so the mapping keeps the winding.
  float code = mix(i_range.w, i_range.z, a_position.z);
  float z = near * far / (far - code / 254.0 * (far - near));
  vec2 t = mix(i_window.xw, i_window.zy, a_position.xy);
  vec3 point = (right * t.x + up * t.y) * z + ahead * (z - i_right_distance.w);
  vec3 eye = rotate(vec4(-i_rotation.xyz, i_rotation.w), -i_center_scale.xyz) / scale;
  float reach = i_right_distance.w - near;  // depth beyond `near` of the centre
  float codes = 254.0 * far / (far - near);
  vec2 first = i_place.xy - vec2(i_window.x, -i_window.y) * texels;
  float pz = dot(point, ahead), ez = dot(eye, ahead);
  v_tile.w = i_right_distance.w + pz;
  v_tile.xy = first * v_tile.w + vec2(dot(point, right), -dot(point, up)) * texels;
  v_tile.z = codes * (reach + pz);
  v_eye.w = i_right_distance.w + ez;
  v_eye.xy = first * v_eye.w + vec2(dot(eye, right), -dot(eye, up)) * texels;
  v_eye.z = codes * (reach + ez);
  vec2 size = vec2(i_window.z - i_window.x, i_window.y - i_window.w) * texels;
  v_low_layer = vec4(i_place.xy, i_range.z, i_place.z);
  v_high = vec4(i_place.xy + size, i_range.w, 0.0);
  vec3 relative = i_center_scale.xyz + rotate(i_rotation, scale * point);
  v_relative = relative;
#ifdef LAYERED
  v_front = i_front.xyz;
  v_behind = i_behind.xyz;
#endif
#ifdef RELIT
  v_right = right;
  v_up = up;
  v_rotation = i_rotation;
#endif
  gl_Position = u_clip_from_relative * vec4(relative, 1.0);
  gl_Position.z = 0.0;  // never clipped: the fragment writes its own depth
}

// Draws a tile on its proxy. Every fragment finds its tile coordinate and the depth stored there,
// and writes that depth, so impostors meet each other and geometry where the objects would.
//   METHOD_PROJECT  the capture ray through the proxy point (quad, cuboid, hull)
//   METHOD_WARP     the capture ray through a point behind the proxy, on the eye's ray (row 15)
precision highp float;
precision highp int;
precision highp sampler2DArray;
in vec3 v_point;
flat in vec3 v_eye;
flat in vec3 v_right;
flat in vec3 v_up;
flat in vec3 v_ahead;
flat in vec4 v_window;
flat in vec4 v_atlas;
flat in vec4 v_depth;
flat in vec4 v_capture;
flat in vec3 v_view_depth;
flat in vec3 v_box_min;
flat in vec3 v_box_max;
flat in float v_depth_slack;
flat in vec3 v_normal;
#if defined(RELIT) || defined(FOG)
flat in vec4 v_rotation;
flat in vec4 v_center_scale;
#endif
#ifdef METHOD_WARP
in float v_parallax;
flat in vec2 v_range;
#endif
precise layout(location = 0) out vec4 o_color;

uniform sampler2DArray u_color;
uniform sampler2DArray u_depth;
uniform float u_near;         // view depth of the near plane
uniform vec2 u_depth_window;  // window depth = x + y / view depth
// ImpostorPass::Fragments. 0: all fragments in one pass. 1: the solid ones, which write depth; then
// 2: the soft ones over them, which do not. Glass must neither hide the things behind it nor blend
// with less than all of them.
uniform int u_fragments;
#ifdef TINT
uniform vec4 u_tint;  // shown instead, without blending
#endif

#if defined(RELIT) || defined(FOG) || defined(SHADOW)
#include "common/rotation.glsl"
#endif
#ifdef SHADOW
#include "impostor/worn_shadow.glsl"
#endif
#ifdef RELIT
#include "impostor/relight.glsl"
#endif
#ifdef FOG
#include "common/fog.glsl"
#endif

const float kSolid = 0.99;

const float kNothing = -1.0;

PRECISE_BUILT_IN(gl_FragDepth)

float capture_depth(vec3 p) { return v_capture.x + dot(p, v_ahead); }
// Capture tangents and depth of a point relative to the centre.
vec3 capture_from_point(vec3 p) {
  float z = capture_depth(p);
  return vec3(dot(p, v_right) / z, dot(p, v_up) / z, z);
}
vec3 point_from_capture(vec2 t, float z) {
  return (v_right * t.x + v_up * t.y) * z + v_ahead * (z - v_capture.x);
}
vec2 texel_from_tangent(vec2 t) { return v_atlas.xy + (t - v_window.xy) * v_atlas.zw; }

bool in_window(vec2 t) {
  return t.x >= v_window.x && t.x <= v_window.z && t.y <= v_window.y && t.y >= v_window.w;
}

// Stored capture depth at a tangent, kNothing if the tile is empty there.
float stored_depth(vec2 t) {
  if (!in_window(t)) return kNothing;
  float code = floor(texelFetch(u_depth, ivec3(texel_from_tangent(t), v_depth.z), 0).r * 255.0 + 0.5);
  if (code < 0.5) return kNothing;
  return v_depth.x * v_depth.y / (v_depth.y - (code - 1.0) / 254.0 * (v_depth.y - v_depth.x));
}
vec4 stored_color(vec2 t) {
  vec2 uv = texel_from_tangent(t) / vec2(textureSize(u_color, 0).xy);
  return texture(u_color, vec3(uv, v_depth.z));
}

void emit(vec4 color, vec3 p) {
  o_color = color * v_depth.w;
  int part = o_color.a < kSolid ? 2 : 1;
  if (o_color.a < 1.0 / 255.0 || (u_fragments != 0 && part != u_fragments)) discard;
#ifdef TINT
  o_color = u_tint;
#endif
  // The depth moves towards the viewer by the largest push-back of quantising, so a shelf at a wall
  // stays in front of it.
  float view_depth = (v_capture.w + dot(v_view_depth, p) - v_depth_slack) * (1.0 - v_capture.z);
  gl_FragDepth = clamp(u_depth_window.x + u_depth_window.y / max(view_depth, u_near), 0.0, 1.0);
}

void main() {
#if !defined(PROXY_QUAD) && !defined(METHOD_WARP)
  // The capture eye did not see a face turned away from it, so the face has no content of its own.
  if (dot(v_normal, -v_ahead * v_capture.x - v_point) <= 0.0) discard;
#endif
  vec3 point = v_point;
#ifdef METHOD_WARP
  vec3 ray = normalize(v_point - v_eye);
  point += v_parallax * ray;
  // The point moves along the ray into the depth range of the content: the bound covers no other
  // depth.
  float off = clamp(capture_depth(point), v_range.x, v_range.y) - capture_depth(point);
  if (off != 0.0) {
    float along = dot(ray, v_ahead);
    if (abs(along) < 1e-4) discard;
    point += ray * (off / along);
  }
#endif
  vec2 t = capture_from_point(point).xy;
  if (!in_window(t)) discard;
  float z = stored_depth(t);
  vec3 p = point_from_capture(t, z > 0.0 ? z : v_capture.y);
  vec4 color = stored_color(t);
#if defined(RELIT) || defined(FOG)
  vec3 relative = v_center_scale.xyz + rotate(v_rotation, v_center_scale.w * p);
#endif
#ifdef RELIT
  color = relit(color, stored_surface(texel_from_tangent(t), v_depth.z), relative, v_right, v_up,
                v_rotation);
#endif
#ifdef SHADOW
  color = shadowed(color, p);
#endif
#ifdef FOG
  color = fogged(color, relative);
#endif
  emit(color, p);
}

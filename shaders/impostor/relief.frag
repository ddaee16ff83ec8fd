// Draws a tile by tracing the stored depth (relief.vert).
precision highp float;
precision highp int;
precision highp sampler2DArray;
flat in vec4 v_slack;
in vec4 v_tile;
flat in vec4 v_eye;
flat in vec4 v_low_layer;
flat in vec4 v_high;
in vec3 v_relative;
#ifdef RELIT
flat in vec3 v_right;
flat in vec3 v_up;
flat in vec4 v_rotation;
#endif
precise layout(location = 0) out vec4 o_color;

uniform int u_fragments;      // 0: all; 1: only solid ones; 2: only soft ones
#ifdef TINT
uniform vec4 u_tint;  // shown instead, without blending
#endif
uniform float u_near;         // view depth of the near plane
uniform float u_depth_of_w;   // view depth where clip-space w is 1
uniform vec2 u_depth_window;  // window depth = x + y / view depth

#if defined(RELIT) || defined(SHADOW)
#include "common/rotation.glsl"
#endif
#ifdef RELIT
#include "impostor/relight.glsl"
#endif
#ifdef SHADOW
flat in vec4 v_center_scale;
#include "impostor/worn_shadow.glsl"
#endif
#ifdef FOG
#include "common/fog.glsl"
#endif
#include "impostor/relief.glsl"

PRECISE_BUILT_IN(gl_FragDepth)

// `along` is the value from trace_tile().
void emit(vec4 color, float along) {
#ifdef SHADOW
  color = shadowed(color, (v_relative * along - v_center_scale.xyz) / v_center_scale.w);
#endif
#ifdef FOG
  color = fogged(color, v_relative * along);
#endif
  o_color = color * v_slack.z;
  int part = o_color.a < kSolid ? 2 : 1;
  if (o_color.a < 1.0 / 255.0 || (u_fragments != 0 && part != u_fragments)) discard;
#ifdef TINT
  o_color = u_tint;
#endif
  float view_depth = (u_depth_of_w * (along / gl_FragCoord.w) - v_slack.y) * (1.0 - v_slack.x);
  gl_FragDepth = clamp(u_depth_window.x + u_depth_window.y / max(view_depth, u_near), 0.0, 1.0);
}

// Traces the ray from `eye` through `tile`, both homogeneous; `along` is 0 at the eye, 1 at the
// proxy. False: the ray misses.
bool trace_tile(vec4 tile, vec4 eye, vec3 low, vec3 high, int layer, out Hit hit, out float along) {
  vec3 point = tile.xyz / tile.w;
  vec3 direction = tile.xyz * eye.w - eye.xyz * tile.w;
  Ray ray;
  if (!clip_ray(point, direction, low, high, ray)) return false;
  hit = trace(ray, layer, kFillReach * max(high.x - low.x, high.y - low.y));
  // The parameter in object space is recovered along the strongest axis of the line.
  vec3 size = abs(ray.span);
  vec3 axis = size.x > size.y && size.x > size.z ? vec3(1, 0, 0)
              : size.y > size.z                  ? vec3(0, 1, 0)
                                                 : vec3(0, 0, 1);
  float s = dot(hit.point - point, axis) / dot(direction, axis);
  along = 1.0 + s * tile.w * tile.w / (1.0 - s * tile.w * (tile.w - eye.w));
  return true;
}

void main() {
  Hit hit;
  float along;
  if (!trace_tile(v_tile, v_eye, v_low_layer.xyz, v_high.xyz, int(v_low_layer.w), hit, along)) {
    discard;
  }
#ifdef RELIT
  // Shades once for everything blended on the way: the nearest solid surface has most of the
  // weight.
  if (hit.color.a > 0.0) {
    Stored s = hit.surface;
    s = Stored(s.normal / hit.color.a, s.roughness / hit.color.a, s.rest / hit.color.a);
    hit.color = relit(hit.color, s, v_relative * along, v_right, v_up, v_rotation);
  }
#endif
  emit(hit.color, along);
}

// Metal-rough surface; output is premultiplied linear light (the target encodes sRGB).
precision highp float;
precision highp int;
in vec3 v_position;
in vec3 v_normal;
in vec4 v_tangent;
in vec2 v_uv0;
in vec2 v_uv1;
// 1 less the vertex colour: only 0 interpolates exactly, so white stays white to the last bit
in vec4 v_shade;
flat in uint v_id;

#ifndef DEPTH_ONLY
precise layout(location = 0) out vec4 o_color;
#endif
#ifdef SEEN
#include "common/seen.glsl"
uniform float u_least_alpha;  // below it, too, a blended surface does not count
#endif
#ifdef WRITE_RANGE
// greatest of 1 less the window depth, and of the window depth
precise layout(location = 1) out vec4 o_range;
#endif
#ifdef WRITE_ID
precise layout(location = 1) out uint o_id;
#endif
#ifdef WRITE_SURFACE
precise layout(location = 1) out vec4 o_normal;
precise layout(location = 2) out vec4 o_material;  // metallic, roughness, occlusion
#endif

#ifdef WRITE_DARKENED
precise layout(location = 1) out vec4 o_darkened;  // o_color is without shadows, this one with them
#endif

uniform vec4 u_base_color;
#ifdef TINT
uniform vec4 u_tint;  // shown instead, without blending
#endif
uniform vec3 u_emissive;
uniform vec4 u_factors;  // metallic, roughness, normal scale, occlusion strength
uniform float u_alpha_cutoff;
uniform float u_mip_bias;
#ifdef BEHIND
// window depth of the part left out, one texel for each u_floor_samples a side
uniform sampler2D u_floor;
uniform int u_floor_samples;
#endif
#ifdef CLEAR
uniform sampler2D u_floor;  // window depths to push away
uniform vec3 u_clear_of;    // view depths of near and far plane; view depth to keep clear

PRECISE_BUILT_IN(gl_FragDepth)

// Keeps the pushed depth, by GL_GREATER, where the target's lies less than the reach behind.
void push_away() {
  float near = u_clear_of.x, far = u_clear_of.y;
  float own = texelFetch(u_floor, ivec2(gl_FragCoord.xy), 0).r;
  float view = near * far / (far - gl_FragCoord.z * (far - near)) + u_clear_of.z;
  float pushed = far * (view - near) / (view * (far - near));
  if (own <= gl_FragCoord.z || own >= pushed) discard;
  gl_FragDepth = min(pushed, 0.9999999);  // 1 is the depth of nothing
}
#endif
#ifdef SWITCHES
// One shader for any material (proofs of leaving out): 1 if it is unlit, if it is opaque.
uniform vec2 u_switches;
#endif
uniform sampler2D u_base_color_map;
uniform sampler2D u_metal_rough_map;
uniform sampler2D u_normal_map;
uniform sampler2D u_occlusion_map;
uniform sampler2D u_emissive_map;
// Per map: uv' = (m0.xy . uv + m0.z, m1.xy . uv + m1.z); m0.w selects the set.
#ifdef LOBES
uniform vec4 u_uv_transform[26];
uniform vec4 u_reflectance;
uniform vec2 u_clearcoat;     // share, roughness
uniform vec4 u_sheen;         // colour, roughness
uniform vec4 u_transmission;  // tint of the way through, share
uniform vec3 u_anisotropy;    // strength; direction in the tangent frame
uniform vec3 u_backdrop;      // colour where no object is
uniform sampler2D u_specular_map;
uniform sampler2D u_specular_color_map;
uniform sampler2D u_clearcoat_map;
uniform sampler2D u_clearcoat_roughness_map;
uniform sampler2D u_clearcoat_normal_map;
uniform sampler2D u_sheen_color_map;
uniform sampler2D u_transmission_map;
uniform sampler2D u_anisotropy_map;
#else
uniform vec4 u_uv_transform[10];
#endif

#ifdef NEED_LIGHTING
#include "common/lighting.glsl"
#ifdef SHADOW
#include "common/shadow.glsl"
#endif
#endif

#ifdef FOG
#include "common/fog.glsl"
#endif

vec2 map_uv(int map) {
  vec4 m0 = u_uv_transform[2 * map];
  vec4 m1 = u_uv_transform[2 * map + 1];
  vec2 uv = m0.w > 0.5 ? v_uv1 : v_uv0;
  return vec2(dot(m0.xy, uv) + m0.z, dot(m1.xy, uv) + m1.z);
}

// `n` tilted by a texel of a normal map.
vec3 mapped_normal(vec3 n, vec3 texel) {
  if (texel.xy == vec2(0.0)) return n;  // neutral: n keeps even its last bits
  vec3 t = normalize(v_tangent.xyz - n * dot(n, v_tangent.xyz));
  vec3 b = cross(n, t) * v_tangent.w;
  vec3 mapped = texel.x * t + texel.y * b + texel.z * n;
  float l = length(mapped);
  return l > 1e-6 ? mapped / l : n;
}

vec3 facing_normal() {
  vec3 n = normalize(v_normal);
  return gl_FrontFacing ? n : -n;
}

vec3 surface_normal() {
  vec3 n = facing_normal();
#ifdef NEED_NORMAL_MAP
  vec3 texel = texture(u_normal_map, map_uv(2)).xyz * 2.0 - 1.0;
  texel.xy *= u_factors.z;
  n = mapped_normal(n, texel);
#endif
  return n;
}

#if defined(NEED_ANISOTROPY) && defined(NEED_LIGHTING)
// KHR_materials_anisotropy, in the tangent frame of normal maps, but projected onto the shaded
// normal: along the mesh's own tangents, a highlight would ignore the normal map. Seen from behind,
// the grain is still that of the front, so its frame does not turn to face the eye.
void read_grain(inout Surface s) {
  s.anisotropy = u_anisotropy.x;
  vec2 turn = u_anisotropy.yz, along = vec2(1.0, 0.0);
#ifdef NEED_ANISOTROPY_MAP
  vec3 texel = texture(u_anisotropy_map, map_uv(12)).rgb;
  s.anisotropy *= texel.b;
  vec2 direction = texel.rg * 2.0 - 1.0;
  float size = length(direction);
  if (size > 0.0) along = direction / size;
#endif
  along = vec2(turn.x * along.x - turn.y * along.y, turn.y * along.x + turn.x * along.y);
  vec3 n = normalize(v_normal);
  vec3 t = normalize(v_tangent.xyz - n * dot(n, v_tangent.xyz));
  vec3 grain = along.x * t + along.y * v_tangent.w * cross(n, t);
  grain -= s.normal * dot(s.normal, grain);
  float l = length(grain);
  if (l > 1e-6) {
    s.grain = grain / l;
  } else {  // the normal map tilts fully along it, or there is no tangent: no direction
    s.grain = vec3(0.0);
    s.anisotropy = 0.0;
  }
}
#endif

#if defined(LOBES) && defined(NEED_LIGHTING)
void read_lobes(inout Surface s) {
  s.reflectance = u_reflectance;
#ifdef NEED_SPECULAR_MAP
  s.reflectance *= texture(u_specular_map, map_uv(5)).a;
#endif
#ifdef NEED_SPECULAR_COLOR_MAP
  s.reflectance.rgb *= texture(u_specular_color_map, map_uv(6)).rgb;
#endif
  s.clearcoat = u_clearcoat.x;
  s.coat_roughness = u_clearcoat.y;
  s.coat_normal = facing_normal();
#ifdef NEED_CLEARCOAT_MAP
  s.clearcoat *= texture(u_clearcoat_map, map_uv(7)).r;
#endif
#ifdef NEED_CLEARCOAT_ROUGHNESS_MAP
  s.coat_roughness *= texture(u_clearcoat_roughness_map, map_uv(8)).g;
#endif
#ifdef NEED_CLEARCOAT_NORMAL_MAP
  s.coat_normal = mapped_normal(s.coat_normal,
                                texture(u_clearcoat_normal_map, map_uv(9)).xyz * 2.0 - 1.0);
#endif
  s.sheen_color = u_sheen.rgb;
  s.sheen_roughness = u_sheen.w;
#ifdef NEED_SHEEN_COLOR_MAP
  s.sheen_color *= texture(u_sheen_color_map, map_uv(10)).rgb;
#endif
  s.transmission = u_transmission.w;
#ifdef NEED_TRANSMISSION_MAP
  s.transmission *= texture(u_transmission_map, map_uv(11)).r;
#endif
  s.transmission *= 1.0 - s.metallic;
#ifdef NEED_ANISOTROPY
  read_grain(s);
#endif
}

#ifdef NEED_TRANSMISSION
// One alpha must serve for all colours. The grey share of the tint is blended. The rest of the
// tint's colour is taken from the backdrop, and so is everything that a rough surface would blur.
// Adds that to `color` and returns the blended share.
float seen_through(Surface s, inout vec3 color) {
  float n_v = clamp(dot(s.normal, -unit(s.position)), 0.0, 1.0);
  float fresnel = s.reflectance.g + (s.reflectance.a - s.reflectance.g) * fifth(1.0 - n_v);
  float share = s.transmission * (1.0 - fresnel);
  vec3 tint = s.albedo * u_transmission.rgb;
  float clear = min(min(tint.r, tint.g), tint.b) * (1.0 - s.roughness);
  color += share * (tint - clear) * u_backdrop;
  return share * clear;
}
#endif
#endif

#ifdef FADE
flat in float v_fade;
#include "common/dither.glsl"
#endif

void main() {
#ifdef BEHIND
  if (gl_FragCoord.z <= texelFetch(u_floor, ivec2(gl_FragCoord.xy) / u_floor_samples, 0).r) discard;
#endif
#ifdef FADE
  if (dithered_away(v_fade)) discard;
#endif
  vec4 base = u_base_color;
#ifdef NEED_VERTEX_COLOR
  base *= 1.0 - v_shade;
#endif
#ifdef NEED_BASE_COLOR_MAP
  base *= texture(u_base_color_map, map_uv(0), u_mip_bias);
#endif
#ifdef NEED_ALPHA_MASK
  if (base.a < u_alpha_cutoff) discard;
#endif
#ifdef SEEN
  if (base.a < max(kSeenAlpha, u_least_alpha)) discard;
#endif
#ifdef CLEAR
  push_away();
#endif
#ifdef WRITE_RANGE
  o_range = vec4(1.0 - gl_FragCoord.z, gl_FragCoord.z, 0.0, 0.0);
#endif
#if defined(DEPTH_ONLY) && defined(WRITE_ID)
  o_id = v_id;
#endif
#ifndef DEPTH_ONLY
#ifdef SWITCHES
  if (u_switches.y > 0.5) base.a = 1.0;
#elif !defined(NEED_BLEND)
  base.a = 1.0;
#endif
#ifdef NEED_LIGHTING
  Surface s;
  s.position = v_position;
  s.normal = surface_normal();
  s.albedo = base.rgb;
  s.metallic = u_factors.x;
  s.roughness = u_factors.y;
  s.occlusion = 1.0;
#ifdef NEED_METAL_ROUGH_MAP
  vec4 mr = texture(u_metal_rough_map, map_uv(1));
  s.roughness *= mr.g;
  s.metallic *= mr.b;
#endif
#ifdef NEED_OCCLUSION_MAP
  s.occlusion = 1.0 + u_factors.w * (texture(u_occlusion_map, map_uv(3)).r - 1.0);
#endif
#ifdef LOBES
  read_lobes(s);
#endif
#ifdef WRITE_SURFACE
  o_normal = vec4(s.normal, 1.0);
  o_material = vec4(s.metallic, s.roughness, s.occlusion, 1.0);
#endif
#if defined(WRITE_SURFACE) && !defined(SWITCHES)
  vec3 color = s.albedo;  // shaded when it is drawn: relight.glsl
#else
#ifdef SHADOW
  s.sun = sun_visibility(v_position, gl_FrontFacing ? normalize(v_normal) : -normalize(v_normal));
#endif
  vec3 color = shade(s);
#ifdef WRITE_DARKENED
  s.sun = 1.0;
  vec3 without = shade(s);
#endif
  vec3 emissive = u_emissive;
#ifdef NEED_EMISSIVE_MAP
  emissive *= texture(u_emissive_map, map_uv(4)).rgb;
#endif
  color += emissive;
#ifdef NEED_TRANSMISSION
#define BLEND_SEEN
  float seen = seen_through(s, color);
#ifdef SWITCHES
  if (u_switches.x > 0.5) seen = 0.0;
#endif
#endif
#ifdef SWITCHES
  if (u_switches.x > 0.5) color = base.rgb;
#endif
#endif
#else
  vec3 color = base.rgb;
#endif
  // Brought to 0 to 1 before blending, as an 8-bit target would do; NaN must never reach the
  // target.
#if defined(NEED_LIGHTING) && defined(SWITCHES)
  color = u_switches.x > 0.5 ? clamp(color, 0.0, 1.0) : shown(color);
#elif defined(NEED_LIGHTING) && !defined(WRITE_SURFACE)
  color = shown(color);
#else
  color = clamp(color, 0.0, 1.0);
#endif
#ifdef WRITE_DARKENED
  o_darkened = vec4(color * base.a, base.a);
#ifdef NEED_LIGHTING
  color = shown(without + emissive);
#endif
#endif
  o_color = vec4(color * base.a, base.a);
#ifdef BLEND_SEEN
  o_color.a -= o_color.a * seen;
#endif
#ifdef FOG
  o_color = fogged(o_color, v_position);
#endif
#ifdef TINT
  o_color = u_tint;
#endif
#ifdef WRITE_ID
  o_id = v_id;
#endif
#endif  // DEPTH_ONLY
}

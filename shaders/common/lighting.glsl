// Lighting shared by tiles, the reference frame and client meshes, so that an impostor matches its
// mesh. Metal-rough BRDF (glTF 2.0 appendix B): Lambert + GGX with Smith visibility. A light's
// colour is irradiance / pi, so a white Lambert surface facing it shows that colour.
const int kMaxLights = 16;
uniform vec3 u_ambient;
uniform int u_light_count;
uniform vec4 u_lights[kMaxLights * 4];  // color+kind, position+range, direction+cos_inner, cos_outer
#ifdef SHADOW
uniform int u_sun;  // index of the light that casts shadows; -1: none
#endif

struct Surface {
  vec3 position;  // relative to the eye
  vec3 normal;
  vec3 albedo;
  float metallic;
  float roughness;
  float occlusion;
#ifdef SHADOW
  float sun;  // share of the sun's light that arrives
#endif
#ifdef LOBES
  vec4 reflectance;  // of a dielectric: at normal incidence, and the greatest at grazing angles
  float transmission;
  vec3 sheen_color;
  float sheen_roughness;
  float clearcoat;
  float coat_roughness;
  vec3 coat_normal;
#endif
#ifdef NEED_ANISOTROPY
  float anisotropy;  // 0 to 1
  vec3 grain;        // unit, along the surface: the rougher direction
#endif
#ifdef SPREAD
  float spread;  // 0: one normal, 1: they cancel out (relit tiles: many leaves in a texel)
#endif
};

#ifdef SPREAD
// Mean of max(n.l, 0) over normals whose mean has length 1 - spread. n.l is taken as Gaussian; the
// variance that unit vectors have left is split evenly among three axes.
float spread_cosine(float n_l, float spread) {
  float mean_length = 1.0 - spread;
  float m = n_l * mean_length;
  float s = max(sqrt((1.0 - mean_length * mean_length) / 3.0), 1e-3);
  float x = clamp(m / s, -20.0, 20.0);
  return max(m / (1.0 + exp(-1.702 * x)) + s * 0.39894 * exp(-0.5 * x * x), 0.0);
}
#endif

float range_window(float distance, float range) {
  if (range <= 0.0) return 1.0;
  float x = distance / range;
  return clamp(1.0 - x * x * x * x, 0.0, 1.0);
}

// Light that arrives at the surface (not yet times cosine), and the direction towards it.
vec3 incoming(int i, Surface s, out vec3 to_light) {
  vec4 color_kind = u_lights[4 * i];
  vec4 position_range = u_lights[4 * i + 1];
  vec4 direction_inner = u_lights[4 * i + 2];
  if (color_kind.w < 0.5) {
    to_light = -normalize(direction_inner.xyz);
    return color_kind.rgb;
  }
  vec3 d = position_range.xyz - s.position;
  float distance2 = max(dot(d, d), 1e-8);
  float distance1 = sqrt(distance2);
  to_light = d / distance1;
  vec3 color = color_kind.rgb * range_window(distance1, position_range.w) / distance2;
  if (color_kind.w > 1.5) {
    float cos_angle = dot(-to_light, normalize(direction_inner.xyz));
    float cos_outer = u_lights[4 * i + 3].x;
    float spot = clamp((cos_angle - cos_outer) / max(direction_inner.w - cos_outer, 1e-4), 0.0, 1.0);
    color *= spot * spot;
  }
  return color;
}

uniform int u_neutral;  // 1: shaded colours go through Khronos PBR Neutral

// Returns a shaded colour as it is shown, 0 to 1: https://github.com/KhronosGroup/ToneMapping
vec3 shown(vec3 color) {
  if (u_neutral == 0) return clamp(color, 0.0, 1.0);
  const float kStart = 0.8 - 0.04, kDesaturation = 0.15;
  vec3 c = clamp(color, 0.0, 65504.0);
  float least = min(c.r, min(c.g, c.b));
  c -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  float peak = max(c.r, max(c.g, c.b));
  if (peak < kStart) return c;
  const float kRoom = 1.0 - kStart;
  float lower = 1.0 - kRoom * kRoom / (peak + kRoom - kStart);
  float share = 1.0 - 1.0 / (kDesaturation * (peak - lower) + 1.0);
  return clamp(mix(c * (lower / peak), vec3(lower), share), 0.0, 1.0);
}

// x to the fifth power, for Schlick's Fresnel term; pow() would cost a logarithm and an
// exponential.
float fifth(float x) { return x * x * (x * x) * x; }

float ggx_specular(float n_l, float n_v, float n_h, float roughness) {
  float a = max(roughness * roughness, 1e-3);
  float a2 = a * a;
  float d = n_h * n_h * (a2 - 1.0) + 1.0;
  float visibility = n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2);
  return a2 / (d * d) * 0.5 / max(visibility, 1e-5);  // D * V * pi
}

// normalize() for lengths whose squares overflow or underflow a float.
vec3 unit(vec3 v) {
  vec3 a = abs(v);
  return normalize(v / max(max(a.x, a.y), a.z));
}

#ifdef NEED_ANISOTROPY
#include "common/anisotropy.glsl"
#endif
#ifdef PROBE
#include "common/probe.glsl"
#endif
#ifdef LOBES
#include "common/lobes.glsl"
#endif

vec3 shade(Surface s) {
  vec3 f0 = mix(vec3(0.04), s.albedo, s.metallic);
  vec3 diffuse = s.albedo * (1.0 - s.metallic);
#ifdef LOBES
  // Lobes only add to the base terms, so a factor of 0 changes no bit.
  f0 += (s.reflectance.rgb - 0.04) * (1.0 - s.metallic);
  float grazing = (s.reflectance.a - 1.0) * (1.0 - s.metallic);  // difference from 1
  vec3 gone = diffuse * s.transmission;
#endif
  vec3 to_eye = -unit(s.position);
  float n_v = max(dot(s.normal, to_eye), 1e-4);
  vec3 result = u_ambient * s.occlusion * mix(s.albedo, f0, s.metallic);
#ifdef LOBES
  result -= u_ambient * s.occlusion * gone;
  diffuse -= gone;
#endif
  for (int i = 0; i < u_light_count; ++i) {
    vec3 to_light;
    vec3 color = incoming(i, s, to_light);
#ifdef SHADOW
    if (i == u_sun) color *= s.sun;
#endif
    float n_l = dot(s.normal, to_light);
#ifdef SPREAD
    n_l = spread_cosine(n_l, s.spread);
#endif
    if (n_l <= 0.0) continue;
    vec3 h = normalize(to_light + to_eye);
    float v_h = clamp(dot(to_eye, h), 0.0, 1.0);
    vec3 fresnel = f0 + (1.0 - f0) * fifth(1.0 - v_h);
#ifdef LOBES
    fresnel += grazing * fifth(1.0 - v_h);
#endif
    float specular = ggx_specular(n_l, n_v, max(dot(s.normal, h), 0.0), s.roughness);
#ifdef NEED_ANISOTROPY
    if (s.anisotropy > 0.0) specular = anisotropic_specular(s, to_eye, to_light, h, n_l, n_v);
#endif
    result += color * n_l * ((1.0 - fresnel) * diffuse + fresnel * specular);
  }
#ifdef PROBE
#ifdef LOBES
  result += probe_light(s, to_eye, f0, grazing, diffuse);
#else
  result += probe_light(s, to_eye, f0, 0.0, diffuse);
#endif
#endif
#ifdef NEED_SHEEN
  result = with_sheen(s, to_eye, result);
#endif
#ifdef NEED_CLEARCOAT
  result = with_clearcoat(s, to_eye, result);
#endif
  return result;
}

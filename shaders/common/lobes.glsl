// Lobes over the metal-rough base, as in the KHR_materials_* extensions: sheen (Charlie
// distribution of Estevez and Kulla 2017, visibility of Neubelt and Pettineo 2013), and a clearcoat
// of index 1.5 over everything. Each is neutral to the last bit at a factor of 0.

float greatest(vec3 v) { return max(max(v.r, v.g), v.b); }

float charlie_sheen(float n_l, float n_v, float n_h, float roughness) {
  float inverse = 1.0 / max(roughness * roughness, 0.005);
  float sine = sqrt(max(1.0 - n_h * n_h, 0.0));
  float distribution = (2.0 + inverse) * pow(sine, inverse) * 0.5;  // times pi
  return distribution / (4.0 * (n_l + n_v - n_l * n_v));
}

// Share of the sheen's colour that surroundings of radiance 1 return: the fit of three.js.
float sheen_albedo(float n_v, float roughness) {
  float r2 = roughness * roughness;
  bool low = roughness < 0.25;
  float a = low ? -339.2 * r2 + 161.4 * roughness - 25.9 : -8.48 * r2 + 14.3 * roughness - 9.95;
  float b = low ? 44.0 * r2 - 23.7 * roughness + 3.26 : 1.97 * r2 - 3.27 * roughness + 0.72;
  return clamp(exp(a * n_v + b) + (low ? 0.0 : 0.1 * (roughness - 0.25)), 0.0, 3.14159);
}

vec3 with_sheen(Surface s, vec3 to_eye, vec3 base) {
  float n_v = max(dot(s.normal, to_eye), 1e-4);
  vec3 light = u_ambient * s.occlusion * sheen_albedo(n_v, s.sheen_roughness);
  for (int i = 0; i < u_light_count; ++i) {
    vec3 to_light;
    vec3 color = incoming(i, s, to_light);
#ifdef SHADOW
    if (i == u_sun) color *= s.sun;
#endif
    float n_l = dot(s.normal, to_light);
    if (n_l <= 0.0) continue;
    float n_h = max(dot(s.normal, normalize(to_light + to_eye)), 0.0);
    light += color * n_l * charlie_sheen(n_l, n_v, n_h, s.sheen_roughness);
  }
#ifdef PROBE
  light += u_probe_light[0].w * s.occlusion * probe_irradiance(probe_axes(s.normal), 1.0) *
           sheen_albedo(n_v, s.sheen_roughness);
#endif
  // Light that the fibres send back does not reach the base: 0.157, as in three.js.
  return base + (s.sheen_color * light - base * (0.157 * greatest(s.sheen_color)));
}

vec3 with_clearcoat(Surface s, vec3 to_eye, vec3 base) {
  float n_v = max(dot(s.coat_normal, to_eye), 1e-4);
  vec3 light = vec3(0.0);
  for (int i = 0; i < u_light_count; ++i) {
    vec3 to_light;
    vec3 color = incoming(i, s, to_light);
#ifdef SHADOW
    if (i == u_sun) color *= s.sun;
#endif
    float n_l = dot(s.coat_normal, to_light);
    if (n_l <= 0.0) continue;
    vec3 h = normalize(to_light + to_eye);
    float fresnel = 0.04 + 0.96 * fifth(1.0 - clamp(dot(to_eye, h), 0.0, 1.0));
    float n_h = max(dot(s.coat_normal, h), 0.0);
    light += color * n_l * fresnel * ggx_specular(n_l, n_v, n_h, s.coat_roughness);
  }
#ifdef PROBE
  vec3 mirrored = normalize(mix(reflect(-to_eye, s.coat_normal), s.coat_normal,
                                s.coat_roughness * s.coat_roughness));
  vec2 ab = brdf_integral(n_v, s.coat_roughness);
  light += u_probe_light[0].w * (0.04 * ab.x + ab.y) *
           probe_radiance(probe_axes(mirrored), s.coat_roughness);
#endif
  light += u_ambient * s.occlusion * 0.04;
  float through = 0.04 + 0.96 * fifth(1.0 - n_v);
  return base + s.clearcoat * (light - base * through);
}

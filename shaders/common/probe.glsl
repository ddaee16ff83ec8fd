// Light from all around: a prefiltered probe (protocol/impostor/light_probe.h). Split sum with the
// multiple scattering of Fdez-Aguera 2019 ("A Multiple-Scattering Microfacet Model for Real-Time
// Image-based Lighting"); its BRDF integral is the fit of Karis 2014 ("Physically Based Shading on
// Mobile").
uniform sampler2D u_probe;
// Rows of the rotation to the probe's axes, with its strength in the first row's w; then irradiance
// / pi.
uniform vec4 u_probe_light[12];

// x, y, edge in texels, as in kProbeLevels.
const vec3 kProbeLevels[6] =
    vec3[6](vec3(0.0, 0.0, 256.0), vec3(256.0, 0.0, 128.0), vec3(256.0, 128.0, 64.0),
            vec3(320.0, 128.0, 32.0), vec3(352.0, 128.0, 32.0), vec3(320.0, 160.0, 32.0));
const vec2 kProbeSize = vec2(384.0, 256.0);

vec3 probe_axes(vec3 d) {
  return vec3(dot(u_probe_light[0].xyz, d), dot(u_probe_light[1].xyz, d),
              dot(u_probe_light[2].xyz, d));
}

vec3 probe_level(vec2 place, int level) {
  vec3 at = kProbeLevels[level];
  return textureLod(u_probe, (at.xy + 1.0 + place * (at.z - 2.0)) / kProbeSize, 0.0).rgb;
}

// Radiance from direction `d` (in the probe's axes) at this roughness.
vec3 probe_radiance(vec3 d, float roughness) {
  d /= abs(d.x) + abs(d.y) + abs(d.z);
  vec2 sides = vec2(d.x < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
  vec2 place = 0.5 + 0.5 * (d.y >= 0.0 ? d.xz : (1.0 - abs(d.zx)) * sides);
  float level = clamp(5.0 + 1.5051500 * log2(max(roughness, 0.1)), 0.0, 5.0);  // 5 log10(r / 0.1)
  int lower = int(min(floor(level), 4.0));
  return mix(probe_level(place, lower), probe_level(place, lower + 1), level - float(lower));
}

// Irradiance / pi for a normal in the probe's axes; its length is below 1 if many normals differ.
vec3 probe_irradiance(vec3 n, float mean_length) {
  float second = mean_length * mean_length * mean_length;
  vec3 linear = u_probe_light[4].rgb * n.y + u_probe_light[5].rgb * n.z +
                u_probe_light[6].rgb * n.x;
  vec3 square = u_probe_light[7].rgb * (n.x * n.y) + u_probe_light[8].rgb * (n.y * n.z) +
                u_probe_light[9].rgb * (3.0 * n.z * n.z - 1.0) +
                u_probe_light[10].rgb * (n.x * n.z) +
                u_probe_light[11].rgb * (n.x * n.x - n.y * n.y);
  return max(u_probe_light[3].rgb + mean_length * linear + second * square, 0.0);
}

// Scale and bias of f0 in the split sum.
vec2 brdf_integral(float n_v, float roughness) {
  vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
  return vec2(-1.04, 1.04) * a + r.zw;
}

// Share of the reflected surroundings that is not hidden if `occlusion` of the diffuse light
// arrives (Lagarde and de Rousiers 2014, "Moving Frostbite to PBR").
float specular_occlusion(float n_v, float occlusion, float roughness) {
  return clamp(pow(n_v + occlusion, exp2(-16.0 * roughness - 1.0)) - 1.0 + occlusion, 0.0, 1.0);
}

// `grazing`: difference of the greatest reflectance from 1.
vec3 probe_light(Surface s, vec3 to_eye, vec3 f0, float grazing, vec3 diffuse) {
  float n_v = clamp(dot(s.normal, to_eye), 0.0, 1.0);
  float mean_length = 1.0;
#ifdef SPREAD
  mean_length = 1.0 - s.spread;
#endif
  vec3 n = probe_axes(s.normal);
  vec3 irradiance = probe_irradiance(n, mean_length);
  vec3 facet = s.normal;
#ifdef NEED_ANISOTROPY
  if (s.anisotropy > 0.0) facet = bent_normal(s, to_eye);
#endif
  // The lobe of a rough surface leans towards the normal.
  vec3 mirrored = normalize(mix(reflect(-to_eye, facet), facet, s.roughness * s.roughness));
  vec3 radiance = probe_radiance(probe_axes(mirrored), s.roughness);
  vec2 ab = brdf_integral(n_v, s.roughness);
  vec3 single = f0 * ab.x + ab.y + grazing * ab.y;
  float lost = 1.0 - (ab.x + ab.y);
  vec3 mean_fresnel = f0 + (1.0 - f0) * 0.047619;  // 1 / 21
  vec3 multiple = single * mean_fresnel / (1.0 - lost * mean_fresnel) * lost;
  vec3 total = single + multiple;
  vec3 body = diffuse * (1.0 - max(max(total.r, total.g), total.b));
  vec3 specular = (radiance * single + irradiance * multiple) *
                  specular_occlusion(n_v, s.occlusion, s.roughness);
  return u_probe_light[0].w * (specular + irradiance * body * s.occlusion);
}

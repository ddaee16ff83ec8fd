// Anisotropy (KHR_materials_anisotropy): reflection that is rougher along the grain than across, as
// on brushed metal. It reads normal, grain, anisotropy and roughness of a Surface.

// GGX with two roughnesses: distribution of Burley 2012 ("Physically-Based Shading at Disney"),
// height-correlated visibility of Heitz 2014, in the form of Filament and of the extension. It
// returns D * V * pi like ggx_specular(), and equals that if both roughnesses are equal. The
// extension's example also clamps V to 1. That is in no derivation, and darkens smooth surfaces at
// grazing angles.
float anisotropic_specular(Surface s, vec3 to_eye, vec3 to_light, vec3 h, float n_l, float n_v) {
  vec3 across = cross(s.normal, s.grain);
  float least = max(s.roughness * s.roughness, 1e-3);
  vec2 a = vec2(mix(least, 1.0, s.anisotropy * s.anisotropy), least);  // along, across
  float a2 = a.x * a.y;
  vec3 d = vec3(a.y * dot(s.grain, h), a.x * dot(across, h), a2 * max(dot(s.normal, h), 0.0));
  float w2 = a2 / dot(d, d);
  vec2 eye = a * vec2(dot(s.grain, to_eye), dot(across, to_eye));
  vec2 light = a * vec2(dot(s.grain, to_light), dot(across, to_light));
  float visibility = n_l * length(vec3(eye, n_v)) + n_v * length(vec3(light, n_l));
  return a2 * w2 * w2 * 0.5 / max(visibility, 1e-5);
}

// The normal whose mirror direction represents the stretched lobe in prefiltered surroundings. It
// turns about the direction across, towards the eye; the smoother the surface is across, the more
// (McAuley 2015, "Rendering the World of Far Cry 4", in the form of Filament; blended as in the
// Khronos sample renderer).
vec3 bent_normal(Surface s, vec3 to_eye) {
  vec3 across = cross(s.normal, s.grain);
  vec3 facing = to_eye - across * dot(across, to_eye);
  float keep = 1.0 - s.anisotropy * (1.0 - s.roughness);
  keep *= keep;
  vec3 bent = mix(facing, s.normal, keep * keep);
  float l = length(bent);
  return l > 1e-6 ? bent / l : s.normal;
}

// Unit vectors on a square, folded about +z: the seams are at -z only.
vec2 octahedral(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  vec2 sides = vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  return n.z >= 0.0 ? p : (1.0 - abs(p.yx)) * sides;
}

vec3 from_octahedral(vec2 p) {
  float z = 1.0 - abs(p.x) - abs(p.y);
  vec2 sides = vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  return normalize(vec3(z >= 0.0 ? p : (1.0 - abs(p.yx)) * sides, z));
}

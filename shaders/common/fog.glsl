// Fog of uniform density, over drawn surfaces and never in a tile (TECHNIQUES row 26). `color` is
// premultiplied, `position` is relative to the eye in world axes.
uniform vec3 u_fog_color;
uniform float u_fog_density;  // per metre

vec4 fogged(vec4 color, vec3 position) {
  float clear = exp(-u_fog_density * length(position));
  return vec4(mix(u_fog_color * color.a, color.rgb, clear), color.a);
}

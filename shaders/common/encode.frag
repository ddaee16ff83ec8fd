// Copies a texture in linear light as opaque sRGB bytes (IEC 61966-2-1), texel for pixel.
precision highp float;
uniform sampler2D u_color;
precise layout(location = 0) out vec4 o_color;

void main() {
  vec3 c = texelFetch(u_color, ivec2(gl_FragCoord.xy), 0).rgb;
  vec3 power = 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055;
  o_color = vec4(mix(power, 12.92 * c, lessThanEqual(c, vec3(0.0031308))), 1.0);
}

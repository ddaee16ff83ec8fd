// Writes the bytes of texels of depth as colours, because a browser cannot read depth itself.
precision highp float;
precision highp sampler2D;
uniform sampler2D u_depth;
uniform ivec2 u_texel;  // the first
layout(location = 0) out vec4 o_bytes;  // of the float, lowest first

void main() {
  uint bits = floatBitsToUint(texelFetch(u_depth, u_texel + ivec2(gl_FragCoord.xy), 0).r);
  o_bytes = vec4(uvec4(bits, bits >> 8u, bits >> 16u, bits >> 24u) & 255u) / 255.0;
}

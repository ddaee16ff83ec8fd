// Copies a texture, texel for pixel.
precision highp float;
uniform sampler2D u_color;
precise layout(location = 0) out vec4 o_color;

void main() { o_color = texelFetch(u_color, ivec2(gl_FragCoord.xy), 0); }

// Lays a picture of premultiplied tints over the framebuffer, texel for pixel.
precision highp float;
uniform sampler2D u_tints;
uniform float u_opacity;
precise layout(location = 0) out vec4 o_color;

void main() { o_color = u_opacity * texelFetch(u_tints, ivec2(gl_FragCoord.xy), 0); }

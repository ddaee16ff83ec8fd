precision highp float;
in vec2 v_texture;
uniform sampler2D u_color;
precise layout(location = 0) out vec4 o_color;

void main() { o_color = vec4(texture(u_color, v_texture).rgb, 1.0); }

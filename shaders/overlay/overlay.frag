precision highp float;
uniform vec4 u_color;
precise layout(location = 0) out vec4 o_color;
void main() { o_color = u_color; }

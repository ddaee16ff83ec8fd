// Text quads in pixels, origin at the top left.
layout(location = 0) in vec2 a_position;
uniform vec2 u_size;
PRECISE_BUILT_IN(gl_Position)

void main() {
  gl_Position = vec4(a_position.x / u_size.x * 2.0 - 1.0, 1.0 - a_position.y / u_size.y * 2.0, 0.0, 1.0);
}

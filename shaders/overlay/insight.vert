// Coloured triangles in clip space.
layout(location = 0) in vec2 a_position;
layout(location = 1) in vec4 a_color;
precise out vec4 v_color;

PRECISE_BUILT_IN(gl_Position)

void main() {
  v_color = a_color;
  gl_Position = vec4(a_position, 0.0, 1.0);
}

// Draws the cells of a view tile at their places in the world.
layout(location = 0) in vec3 a_position;  // relative to the eye the view was taken from, world
layout(location = 1) in vec2 a_texture;
uniform mat4 u_clip_from_relative;
uniform vec3 u_offset;                    // that eye, relative to the present one
precise out vec2 v_texture;

PRECISE_BUILT_IN(gl_Position)

void main() {
  v_texture = a_texture;
  gl_Position = u_clip_from_relative * vec4(a_position + u_offset, 1.0);
}

// Meshes: tiles (one instance, object space), the reference frame and client geometry (instanced).
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 a_tangent;
layout(location = 3) in vec2 a_uv0;
layout(location = 4) in vec2 a_uv1;
layout(location = 5) in vec4 a_color;
layout(location = 6) in vec4 i_rotation;        // unit quaternion xyzw
layout(location = 7) in vec4 i_position_scale;  // relative to the eye; uniform scale
layout(location = 8) in uint i_id;

uniform mat4 u_clip_from_relative;
uniform float u_point_size;

#ifdef FADE
layout(location = 9) in float i_fade;
precise flat out float v_fade;
#endif

precise out vec3 v_position;
precise out vec3 v_normal;
precise out vec4 v_tangent;
precise out vec2 v_uv0;
precise out vec2 v_uv1;
precise out vec4 v_shade;
precise flat out uint v_id;

#include "common/rotation.glsl"

// Two programs draw alpha-tested surfaces, and the second must get exactly the depth of the first.
invariant gl_Position;
PRECISE_BUILT_IN(gl_Position)

void main() {
  v_position = i_position_scale.xyz + rotate(i_rotation, i_position_scale.w * a_position);
  v_normal = rotate(i_rotation, a_normal);
  v_tangent = vec4(rotate(i_rotation, a_tangent.xyz), a_tangent.w);
  v_uv0 = a_uv0;
  v_uv1 = a_uv1;
  v_shade = 1.0 - a_color;
  v_id = i_id;
  gl_PointSize = u_point_size;
  gl_Position = u_clip_from_relative * vec4(v_position, 1.0);
#ifdef FADE
  v_fade = i_fade;
  // A fading mesh is 3 % nearer than the impostor it replaces (the matrix turns, but does not
  // move).
  if (i_fade < 1.0) gl_Position.z += 0.03 * u_clip_from_relative[3].z;
#endif
}

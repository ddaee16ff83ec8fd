// The convex hull of an object without an image yet, in its mean colour.
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec4 i_rotation;
layout(location = 3) in vec4 i_center_scale;
layout(location = 4) in vec4 i_color;   // linear; a: opacity, negative if the far sides are drawn
layout(location = 11) in vec4 i_center;
uniform mat4 u_clip_from_relative;
precise flat out vec4 v_color;
precise out vec3 v_relative;  // relative to the eye, world

#include "common/rotation.glsl"

PRECISE_BUILT_IN(gl_Position)

void main() {
  vec3 normal = rotate(i_rotation, a_normal);
  float opacity = abs(i_color.a);
  float light = 0.7 + 0.3 * sign(i_color.a) * normal.y;
  v_color = vec4(i_color.rgb * light * opacity, opacity);
  vec3 p = i_center_scale.xyz + rotate(i_rotation, i_center_scale.w * (a_position - i_center.xyz));
  v_relative = p;
  gl_Position = u_clip_from_relative * vec4(p, 1.0);
}

// Vertical gradient by view direction. Alpha stays 0: the sky is not an object.
precision highp float;
in vec2 v_ndc;
precise layout(location = 0) out vec4 o_color;
uniform vec3 u_right;    // camera right * tan(half horizontal fov)
uniform vec3 u_up;       // camera up * tan(half vertical fov)
uniform vec3 u_forward;
uniform vec3 u_zenith;
uniform vec3 u_horizon;
uniform vec3 u_nadir;

void main() {
  float y = normalize(u_forward + v_ndc.x * u_right + v_ndc.y * u_up).y;
  vec3 far_color = y >= 0.0 ? u_zenith : u_nadir;
  o_color = vec4(mix(u_horizon, far_color, sqrt(abs(y))), 0.0);
}

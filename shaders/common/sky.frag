// Background: a vertical gradient by view direction, and the floor of a studio. Alpha stays 0: it is
// not an object. FLOOR: there is a floor, which the scene shades.
precision highp float;
precision highp int;
in vec2 v_ndc;
precise layout(location = 0) out vec4 o_color;
uniform vec3 u_right;    // camera right * tan(half horizontal fov)
uniform vec3 u_up;       // camera up * tan(half vertical fov)
uniform vec3 u_forward;
uniform vec3 u_zenith;
uniform vec3 u_horizon;
uniform vec3 u_nadir;
#ifdef FLOOR
uniform vec4 u_floor;        // its middle relative to the eye; half the side of the shadow's square
uniform vec3 u_floor_color;
uniform sampler2D u_floor_shadow;

// The floor fades into the gradient within these distances, in halves of the square.
const float kWhole = 1.0, kFaded = 6.0;

vec3 over_floor(vec3 color, vec3 ray) {
  if (u_floor.y >= 0.0 || ray.y >= 0.0) return color;  // seen from below, or above the horizon
  vec2 at = (ray.xz * (u_floor.y / ray.y) - u_floor.xz) / u_floor.w;
  float away = length(at);
  if (!(away < kFaded)) return color;
  vec2 place = clamp(0.5 * at + 0.5, 0.0, 1.0);
  vec3 shaded = u_floor_color * (1.0 - texture(u_floor_shadow, place).r);
  return mix(shaded, color, smoothstep(kWhole, kFaded, away));
}
#endif

void main() {
  vec3 ray = normalize(u_forward + v_ndc.x * u_right + v_ndc.y * u_up);
  vec3 far_color = ray.y >= 0.0 ? u_zenith : u_nadir;
#ifdef FLOOR  // a studio has no line where its walls begin
  vec3 color = mix(u_horizon, far_color, smoothstep(0.0, 0.7, abs(ray.y)));
  color = over_floor(color, ray);
#else
  vec3 color = mix(u_horizon, far_color, sqrt(abs(ray.y)));
#endif
  o_color = vec4(color, 0.0);
}

// Visibility of the sun at a point, from a map of the scene as the sun sees it (sun_frame.h).
uniform highp sampler2DShadow u_shadow_map;
uniform mat4 u_map_from_relative;
uniform vec3 u_to_sun;        // world
uniform vec2 u_shadow_texel;  // of the map: m, and relative to its edge

// The filter reads 2 x 2 points, each between four texels. That is up to 1.5 texels away along
// either axis, 2.1 in all. There, a surface at angle a to the light is 2.1 texels * tan(a) nearer
// to it. Moving the point along its normal by 2.1 texels * sin(a) puts it in front of all of that;
// half a texel more allows for rounding.
const float kReach = 2.1;
const float kRounding = 0.5;

// `position` is relative to the eye; `normal` is the unit normal of the geometry; both in world
// axes.
float sun_visibility(vec3 position, vec3 normal) {
  float cosine = dot(normal, u_to_sun);
  if (cosine <= 0.0) return 0.0;  // the surface shadows itself, whatever a normal map says
  float sine = sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0));
  vec3 moved = position + normal * (kReach * u_shadow_texel.x * sine) +
               u_to_sun * (kRounding * u_shadow_texel.x);
  vec3 at = (u_map_from_relative * vec4(moved, 1.0)).xyz;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  float sum = 0.0;
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) {
      sum += texture(u_shadow_map, vec3(at.xy + (vec2(x, y) - 0.5) * u_shadow_texel.y, at.z));
    }
  }
  return 0.25 * sum;
}

#include "protocol/impostor/sun_frame.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "protocol/base/stable_math.h"

namespace mirage {

const Light* sun_of(const Lighting& lighting) {
  const Light* sun = nullptr;
  float strongest = 0;
  for (const Light& light : lighting.lights) {
    const float luminance = glm::dot(light.color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
    if (light.kind != LightKind::kDirectional || !(luminance > strongest)) continue;
    sun = &light;
    strongest = luminance;
  }
  return sun;
}

SunFrame::SunFrame(const glm::vec3& direction, const glm::dvec3& center_in, double radius_in,
                   int edge_in)
    : forward(safe_normalize(glm::dvec3(direction))),
      center(center_in),
      radius(radius_in),
      edge(edge_in) {
  // Duff et al. 2017: a basis without a singular direction.
  const glm::dvec3 n = -forward;
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z), b = n.x * n.y * a;
  right = {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  up = {b, sign + n.y * n.y * a, -n.y};
}

glm::mat4 SunFrame::clip_from_relative(const glm::dvec3& eye) const {
  const glm::dmat4 turned = glm::transpose(glm::dmat4(glm::dmat3(right, up, forward)));
  const glm::dmat4 moved = glm::translate(glm::dmat4(1), eye - center);
  return glm::mat4(glm::scale(glm::dmat4(1), glm::dvec3(1.0 / radius)) * turned * moved);
}

glm::mat4 SunFrame::map_from_relative(const glm::dvec3& eye) const {
  const glm::mat4 half = glm::scale(glm::translate(glm::mat4(1), glm::vec3(0.5f)), glm::vec3(0.5f));
  return half * clip_from_relative(eye);
}

}  // namespace mirage

#include "protocol/model/sun_place.h"

#include <cmath>
#include <glm/glm.hpp>

#include "protocol/model/scene_types.h"

namespace mirage {
namespace {
constexpr double kRadians = 0.017453292519943295;  // of a degree
}  // namespace

std::optional<SunPlace> sun_place(const Lighting& lighting) {
  for (const Light& one : lighting.lights) {
    if (one.kind != LightKind::kDirectional) continue;
    const glm::dvec3 to_sun = -glm::dvec3(one.direction);
    return SunPlace{std::atan2(to_sun.x, -to_sun.z) / kRadians,
                    std::asin(glm::clamp(to_sun.y, -1.0, 1.0)) / kRadians};
  }
  return std::nullopt;
}

void put_sun(const SunPlace& at, Lighting& lighting) {
  const double azimuth = at.azimuth * kRadians, elevation = at.elevation * kRadians;
  const glm::dvec3 to_sun(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                          -std::cos(azimuth) * std::cos(elevation));
  for (Light& one : lighting.lights) {
    if (one.kind == LightKind::kDirectional) one.direction = glm::vec3(-to_sun);
  }
}

}  // namespace mirage

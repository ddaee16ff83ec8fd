#include "protocol/impostor/tile.h"

#include <algorithm>
#include <cmath>

#include "protocol/base/stable_math.h"

namespace mirage {

double capture_half_tangent(double radius, double distance, std::uint32_t edge) {
  const double cone = radius / tangent_length(distance, radius);
  return cone * edge / (edge - 2.0);
}

DepthCode::DepthCode(double radius, double distance)
    : near_depth(distance - radius), far_depth(distance + radius) {}

std::uint8_t DepthCode::encode(double depth) const {
  const double z = std::clamp(depth, near_depth, far_depth);
  const double u = far_depth * (z - near_depth) / (z * (far_depth - near_depth));
  return static_cast<std::uint8_t>(1 + std::lround(u * 254.0));
}

double DepthCode::decode(std::uint8_t code) const {
  const double u = (std::max<int>(code, 1) - 1) / 254.0;
  return near_depth * far_depth / (far_depth - u * (far_depth - near_depth));
}

double DepthCode::quantum() const {
  const double step = 0.5 / 254.0;
  const double u = 1.0 - step;
  return far_depth - near_depth * far_depth / (far_depth - u * (far_depth - near_depth));
}

double DepthCode::inverse_quantum() const {
  return 0.5 / 254.0 * (far_depth - near_depth) / (near_depth * far_depth);
}

}  // namespace mirage

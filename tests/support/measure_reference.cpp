#include "tests/support/measure_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mirage::test {
namespace {

constexpr float kMissed = std::numeric_limits<float>::quiet_NaN();

std::vector<float> plain_entries(const std::vector<Plane>& planes, const Capture& capture,
                                 const glm::dvec3& center, const TileCrop& crop) {
  const glm::dvec3 eye = capture.eye();
  const glm::dvec2 first(crop.x + 0.5, crop.y + 0.5);
  const glm::dvec3 corner = capture.point_from_texel(first, 1.0);
  const glm::dvec3 along_x = capture.point_from_texel(first + glm::dvec2(1, 0), 1.0) - corner;
  const glm::dvec3 along_y = capture.point_from_texel(first + glm::dvec2(0, 1), 1.0) - corner;
  std::vector<float> out;
  for (std::uint32_t y = 0; y < crop.h; ++y) {
    for (std::uint32_t x = 0; x < crop.w; ++x) {
      double enter = std::numeric_limits<double>::infinity(), leave = 0;
      for (const Plane& plane : planes) {
        const glm::dvec3 n(plane.normal);
        double gap = plane.offset - glm::dot(n, center + eye);
        if (gap == 0) gap = std::numeric_limits<double>::min();
        const double sign = gap < 0 ? 1 : -1;
        const double at_corner = sign * glm::dot(n, corner - eye) / gap;
        const double step_x = sign * glm::dot(n, along_x) / gap;
        const double step_y = sign * glm::dot(n, along_y) / gap;
        double& least = gap < 0 ? enter : leave;
        least = std::min(least, at_corner + step_y * y + step_x * x);
      }
      const bool met = enter > 0 && enter >= -leave;
      out.push_back(met ? static_cast<float>(1 / enter) : kMissed);
    }
  }
  return out;
}

// Calls `visit` with the index of each texel around one, itself included.
template <typename Visit>
void for_around(const TileCrop& crop, std::uint32_t x, std::uint32_t y, Visit visit) {
  for (std::uint32_t ny = y > 0 ? y - 1 : 0; ny <= std::min(y + 1, crop.h - 1); ++ny) {
    for (std::uint32_t nx = x > 0 ? x - 1 : 0; nx <= std::min(x + 1, crop.w - 1); ++nx) {
      visit(std::size_t{ny} * crop.w + nx);
    }
  }
}

float depth_of(std::uint8_t code, const Capture& capture) {
  if (code == 0) return 0;
  return static_cast<float>(DepthCode(capture.radius, capture.distance).decode(code));
}

float largest_gap(const Tile& tile, const Capture& capture) {
  float gap = 0;
  const auto grow = [&](std::size_t i, std::size_t k) {
    if (tile.depth[i] == 0 || tile.depth[k] == 0) return;
    const float a = depth_of(tile.depth[i], capture), b = depth_of(tile.depth[k], capture);
    gap = std::max(gap, std::abs(a - b));
  };
  for (std::size_t y = 0; y < tile.crop.h; ++y) {
    for (std::size_t x = 0; x < tile.crop.w; ++x) {
      const std::size_t at = y * tile.crop.w + x;
      if (x + 1 < tile.crop.w) grow(at, at + 1);
      if (y + 1 < tile.crop.h) grow(at, at + tile.crop.w);
    }
  }
  return gap;
}

}  // namespace

float plain_difference(const std::vector<Plane>& planes, const Capture& capture,
                       const glm::dvec3& center, const TileCrop& crop,
                       const std::vector<std::uint8_t>& codes) {
  const std::vector<float> entries = plain_entries(planes, capture, center, crop);
  const auto dc = static_cast<float>(capture.distance);
  float worst = 0;
  for (std::uint32_t y = 0; y < crop.h; ++y) {
    for (std::uint32_t x = 0; x < crop.w; ++x) {
      const float depth = depth_of(codes[std::size_t{y} * crop.w + x], capture);
      if (depth == 0) continue;
      float near = std::numeric_limits<float>::infinity(), far = 0;
      for_around(crop, x, y, [&](std::size_t i) {
        if (std::isnan(entries[i])) return;
        near = std::min(near, entries[i]);
        far = std::max(far, entries[i]);
      });
      if (far == 0) return static_cast<float>(100.0 * capture.distance);
      const float scale = dc / depth;
      worst = std::max(worst, std::abs(depth - near) * scale * (dc / near));
      worst = std::max(worst, std::abs(depth - far) * scale * (dc / far));
    }
  }
  return worst;
}

TileMeasure plain_measure(const Tile& tile, const std::vector<std::uint8_t>& behind,
                          const Capture& capture, const ObjectDescription& object) {
  TileMeasure m;
  const DepthCode code(capture.radius, capture.distance);
  const auto quantum = static_cast<float>(code.quantum());
  const auto dc = static_cast<float>(capture.distance);
  float least = std::numeric_limits<float>::infinity(), greatest = 0;
  for (std::size_t i = 0; i < tile.depth.size(); ++i) {
    const float z = depth_of(tile.depth[i], capture);
    const float farther = behind.empty() ? z : depth_of(behind[i], capture);
    if (z > 0) least = std::min(least, z);
    greatest = std::max(greatest, std::max(z, farther));
    if (z == 0 || behind.empty() || tile.layered()) continue;
    m.dz_behind = std::max(m.dz_behind, (dc / z - dc / farther) * dc * 1.00001f);
  }
  if (std::isinf(least)) return {};
  m.depth_min = std::max(least - quantum, 0.0f);
  m.depth_max = greatest + quantum;
  m.plane_depth = 2.0f * m.depth_min * m.depth_max / (m.depth_min + m.depth_max);
  m.dz_quad = 0.5f * dc * dc * (m.depth_max - m.depth_min) / (m.depth_min * m.depth_max) * 1.00001f;
  m.depth_gap = largest_gap(tile, capture);
  const auto step =
      static_cast<float>(code.inverse_quantum() * capture.distance * capture.distance);
  const auto off = [&](const std::vector<Plane>& planes) {
    const glm::dvec3 center(object.center);
    float worst = plain_difference(planes, capture, center, tile.crop, tile.depth);
    if (!behind.empty()) {
      worst = std::max(worst, plain_difference(planes, capture, center, tile.crop, behind));
    }
    return worst + step;
  };
  m.dz_cuboid = off(box_planes(object.box_min, object.box_max));
  const std::vector<Plane> hull = object.hull.planes();
  m.dz_hull = hull.empty() ? m.dz_cuboid : off(hull);
  return m;
}

}  // namespace mirage::test

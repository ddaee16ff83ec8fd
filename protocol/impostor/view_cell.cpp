#include "protocol/impostor/view_cell.h"

#include <algorithm>
#include <cmath>

#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"

namespace mirage {
namespace {

double sign_not_zero(double v) { return std::signbit(v) ? -1.0 : 1.0; }

std::uint32_t grid_index(double coordinate, std::uint32_t n) {
  const double cell = std::floor((coordinate * 0.5 + 0.5) * n);
  return static_cast<std::uint32_t>(std::clamp(cell, 0.0, static_cast<double>(n - 1)));
}

}  // namespace

bool valid(const ViewCell& cell) {
  if (cell.level > limits::kMaxViewLevel) return false;
  const std::uint32_t n = 1u << cell.level;
  return cell.x < n && cell.y < n;
}

std::optional<ViewCell> view_cell_from_direction(const glm::dvec3& v, int level) {
  const glm::dvec3 u = safe_normalize(v);
  if (u == glm::dvec3(0)) return std::nullopt;
  const double l1 = std::abs(u.x) + std::abs(u.y) + std::abs(u.z);
  double px = u.x / l1, py = u.z / l1;
  if (u.y < 0) {
    const double fx = (1.0 - std::abs(py)) * sign_not_zero(px);
    const double fy = (1.0 - std::abs(px)) * sign_not_zero(py);
    px = fx;
    py = fy;
  }
  ViewCell cell;
  cell.level = static_cast<std::uint8_t>(std::clamp(level, 0, limits::kMaxViewLevel));
  const std::uint32_t n = 1u << cell.level;
  cell.x = static_cast<std::uint16_t>(grid_index(px, n));
  cell.y = static_cast<std::uint16_t>(grid_index(py, n));
  return cell;
}

glm::dvec3 direction_from_view_cell(const ViewCell& cell) {
  const double n = static_cast<double>(1u << cell.level);
  double px = (cell.x + 0.5) / n * 2.0 - 1.0;
  double py = (cell.y + 0.5) / n * 2.0 - 1.0;
  const double y = 1.0 - std::abs(px) - std::abs(py);
  if (y < 0) {
    const double fx = (1.0 - std::abs(py)) * sign_not_zero(px);
    const double fy = (1.0 - std::abs(px)) * sign_not_zero(py);
    px = fx;
    py = fy;
  }
  return glm::normalize(glm::dvec3(px, y, py));
}

// 3 sqrt 2 / n: half a cell's diagonal, sqrt 6 / n on the octahedron, is seen from sqrt 3 at most.
double view_cell_angle(int level) { return 4.2426407 / static_cast<double>(1u << level); }

int view_level_for_angle(double angle) {
  if (!(angle > 0)) return limits::kMaxViewLevel;
  int level = 0;
  while (level < limits::kMaxViewLevel && view_cell_angle(level) > angle) ++level;
  return level;
}

bool valid(const DistanceBucket& bucket) {
  if (bucket.level > limits::kMaxDistanceLevel) return false;
  const double radii = radii_from_distance_bucket(bucket);
  return radii >= limits::kMinCaptureRadii && radii <= limits::kMaxCaptureRadii;
}

std::optional<DistanceBucket> distance_bucket_from_radii(double distance_radii, int level) {
  if (!std::isfinite(distance_radii) || distance_radii <= 0) return std::nullopt;
  DistanceBucket bucket;
  bucket.level = static_cast<std::uint8_t>(std::clamp(level, 0, limits::kMaxDistanceLevel));
  const double per_octave = static_cast<double>(1u << bucket.level);
  const double radii =
      std::clamp(distance_radii, limits::kMinCaptureRadii, limits::kMaxCaptureRadii);
  bucket.index = static_cast<std::int32_t>(std::floor(std::log2(radii) * per_octave));
  // Close to the swap distance, the bucket's middle may lie inside it; the next bucket outwards is
  // taken then.
  while (radii_from_distance_bucket(bucket) < limits::kMinCaptureRadii) ++bucket.index;
  while (radii_from_distance_bucket(bucket) > limits::kMaxCaptureRadii) --bucket.index;
  return bucket;
}

double radii_from_distance_bucket(const DistanceBucket& bucket) {
  return std::exp2((bucket.index + 0.5) / static_cast<double>(1u << bucket.level));
}

CaptureBasis capture_basis(const ViewCell& cell) {
  const glm::dvec3 d = direction_from_view_cell(cell);
  CaptureBasis basis;
  basis.forward = -d;
  const bool near_pole = d.x * d.x + d.z * d.z < 1e-6;
  const glm::dvec3 up_hint = near_pole ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
  basis.right = glm::normalize(glm::cross(up_hint, d));
  basis.up = glm::cross(d, basis.right);
  return basis;
}

}  // namespace mirage

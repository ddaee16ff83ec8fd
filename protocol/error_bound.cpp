#include "protocol/error_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/limits.h"
#include "protocol/stable_math.h"

namespace mirage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double tan_cone(double radius, double distance) {
  return distance > radius ? radius / tangent_length(distance, radius) : kInfinity;
}

}  // namespace

double baseline_term(const ViewGeometry& view, const CaptureGeometry& capture) {
  const glm::dvec3 baseline = view.eye - capture.axis * capture.distance;
  const double along = glm::dot(baseline, capture.axis);
  const double across = glm::length(baseline - capture.axis * along);
  return across + std::abs(along) * tan_cone(view.radius, capture.distance);
}

double baseline_term(double distance, double capture_distance, double theta, double radius) {
  const double along = (distance - capture_distance) - distance * one_minus_cos(theta);
  return distance * std::sin(theta) + std::abs(along) * tan_cone(radius, capture_distance);
}

double position_bound_px(const ViewGeometry& view, const CaptureGeometry& capture,
                         const DrawnDepth& drawn) {
  const double distance = glm::length(view.eye);
  const double near_surface = view.center_depth - view.radius;
  const double near_drawn = view.center_depth - drawn.q;
  const bool outside = distance >= limits::kMinCaptureRadii * view.radius &&
                       capture.distance >= limits::kMinCaptureRadii * view.radius * (1 - 1e-9);
  if (!outside || !(near_surface > 0) || !(near_drawn > 0)) return kInfinity;
  if (!std::isfinite(near_surface) || !std::isfinite(near_drawn)) return kInfinity;
  const double bound =
      view.focal_px * drawn.dz * baseline_term(view, capture) / (near_surface * near_drawn);
  return bound >= 0 ? bound : kInfinity;
}

double motion_bound_px(const ViewGeometry& view, double travel) {
  if (travel == 0) return 0;
  const double distance = glm::length(view.eye);
  const double near_surface = view.center_depth - view.radius;
  if (!(near_surface > 0) || !(distance > view.radius)) return kInfinity;
  const double off_axis = std::acos(std::clamp(view.center_depth / distance, -1.0, 1.0)) +
                          std::asin(view.radius / distance);
  const double cosine = std::cos(off_axis);
  const double bound = view.focal_px * travel / (near_surface * cosine);
  return cosine > 0 && bound >= 0 ? bound : kInfinity;
}

double point_error_px(double focal_px, const glm::dvec3& p, const glm::dvec3& q,
                      const glm::dvec3& forward, const glm::dvec3& right, const glm::dvec3& up) {
  const double zp = glm::dot(p, forward), zq = glm::dot(q, forward);
  if (!(zp > 0) || !(zq > 0)) return kInfinity;
  // The difference is formed before the projection: p and q are close, their images closer.
  const glm::dvec3 d = q - p;
  const double dz = zq - zp;
  const double dx = (glm::dot(d, right) * zp - glm::dot(p, right) * dz) / (zp * zq);
  const double dy = (glm::dot(d, up) * zp - glm::dot(p, up) * dz) / (zp * zq);
  return focal_px * std::hypot(dx, dy);
}

double texel_size_px(const ViewGeometry& view, const CaptureGeometry& capture, double texels) {
  const double near_surface = view.center_depth - view.radius;
  if (!(near_surface > 0) || !(texels > 0)) return kInfinity;
  // A texel's width at the object's centre, seen at the depth of the centre: content sits around
  // it.
  const double width = 2.0 * tan_cone(view.radius, capture.distance) * capture.distance / texels;
  return view.focal_px * width / view.center_depth;
}

double lod_error_px(const ViewGeometry& view, double error) {
  if (!(error > 0)) return 0.0;
  const double nearest = view.center_depth - view.radius;
  return nearest > 0 ? view.focal_px * error / nearest : std::numeric_limits<double>::infinity();
}

double footprint_px(double texel_px) { return 0.5 * std::max(0.0, texel_px - 1.0); }

}  // namespace mirage

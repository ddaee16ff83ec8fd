#include "protocol/impostor/error_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"

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

namespace {

struct Corners {
  double least_ahead = 0;  // n.u
  double sideways = 0;     // |n x (u x B)|
};

// Extremes over the window of the content. Without a known n, the whole |u x B| counts.
Corners window_corners(const ViewGeometry& view, const CaptureGeometry& capture,
                       const glm::dvec3& baseline) {
  glm::dvec3 right = capture.right, up = capture.up;
  glm::dvec2 low = capture.low, high = capture.high;
  if (right == glm::dvec3(0)) {
    const glm::dvec3 any =
        std::abs(capture.axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    right = glm::normalize(glm::cross(any, capture.axis));
    up = glm::cross(capture.axis, right);
    high = glm::dvec2(tan_cone(view.radius, capture.distance));
    low = -high;
  }
  const bool known = view.forward != glm::dvec3(0);
  Corners out{kInfinity, 0};
  for (const double x : {low.x, high.x}) {
    for (const double y : {low.y, high.y}) {
      const glm::dvec3 u = right * x + up * y - capture.axis;
      const glm::dvec3 moment = glm::cross(u, baseline);
      out.least_ahead = std::min(out.least_ahead, glm::dot(view.forward, u));
      out.sideways =
          std::max(out.sideways, glm::length(known ? glm::cross(view.forward, moment) : moment));
    }
  }
  return out;
}

// Least ratio of eye depth to capture depth over points of the range. It comes from the window, or
// from the sphere, whose nearest point has eye depth `nearest`.
double least_ratio(double g, double least_ahead, double low, double high, double nearest) {
  return std::max(std::min(g / low, g / high) + least_ahead, nearest / high);
}

}  // namespace

double position_bound_px(const ViewGeometry& view, const CaptureGeometry& capture,
                         const DrawnDepth& drawn) {
  const double distance = glm::length(view.eye), dc = capture.distance;
  const double near_surface = view.center_depth - view.radius;
  const double near_drawn = view.center_depth - drawn.q;
  const bool outside = distance >= limits::kMinCaptureRadii * view.radius &&
                       dc >= limits::kMinCaptureRadii * view.radius * (1 - 1e-9);
  // If the depth range of the drawn points is known, the window tells how near the eye they come.
  const bool placed = drawn.drawn_max > 0;
  if (!outside || !(near_surface > 0) || !(placed || near_drawn > 0)) return kInfinity;
  if (!std::isfinite(near_surface) || !std::isfinite(near_drawn)) return kInfinity;
  const bool measured = drawn.surface_max > 0;
  const double surface_min = measured ? drawn.surface_min : dc - view.radius;
  const double surface_max = measured ? drawn.surface_max : dc + view.radius;
  const double drawn_min = placed ? drawn.drawn_min : std::max(dc - drawn.q, 0.0);
  const double drawn_max = placed ? drawn.drawn_max : dc + drawn.q;
  const glm::dvec3 baseline = view.eye - capture.axis * dc;
  if (!is_finite(baseline) || !is_finite(view.forward) || !std::isfinite(drawn.dz)) {
    return kInfinity;  // min and max below would swallow a NaN
  }
  const Corners corners = window_corners(view, capture, baseline);
  // Without a known n, only the spheres bound the depths.
  const bool known = view.forward != glm::dvec3(0);
  const double g = known ? -glm::dot(view.forward, baseline) : 0.0;
  const double ahead = known ? corners.least_ahead : -kInfinity;
  const double surface = least_ratio(g, ahead, surface_min, surface_max, near_surface);
  const double shown = least_ratio(g, ahead, drawn_min, drawn_max, near_drawn);
  const double bound =
      view.focal_px * (drawn.dz / (dc * dc)) * corners.sideways / (surface * shown);
  return bound >= 0 && surface > 0 && shown > 0 ? bound : kInfinity;
}

double motion_bound_px(const ViewGeometry& view, double travel) {
  if (travel == 0) return 0;
  const double distance = glm::length(view.eye);
  const double near_surface = view.center_depth - view.radius;
  if (!(near_surface > 0) || !(distance > view.radius)) return kInfinity;
  // Both angles use atan2: acos and asin lose half their digits near the axis and the rim.
  const double aside = tangent_length(distance, std::clamp(view.center_depth, -distance, distance));
  const double off_axis = std::atan2(aside, view.center_depth) +
                          std::atan2(view.radius, tangent_length(distance, view.radius));
  const double cosine = std::cos(off_axis);
  const double bound = view.focal_px * travel / (near_surface * cosine);
  return cosine > 0 && bound >= 0 ? bound : kInfinity;
}

double point_error_px(double focal_px, const glm::dvec3& p, const glm::dvec3& q,
                      const glm::dvec3& forward, const glm::dvec3& right, const glm::dvec3& up) {
  const double zp = glm::dot(p, forward), zq = glm::dot(q, forward);
  if (!(zp > 0) || !(zq > 0)) return kInfinity;
  // Subtracting before projecting keeps digits: p and q are close, and their images are closer.
  const glm::dvec3 d = q - p;
  const double dz = zq - zp;
  const double dx = (glm::dot(d, right) * zp - glm::dot(p, right) * dz) / (zp * zq);
  const double dy = (glm::dot(d, up) * zp - glm::dot(p, up) * dz) / (zp * zq);
  return focal_px * std::hypot(dx, dy);
}

double texel_size_px(const ViewGeometry& view, const CaptureGeometry& capture, double texels) {
  const double near_surface = view.center_depth - view.radius;
  if (!(near_surface > 0) || !(texels > 0)) return kInfinity;
  // The width of a texel at the object's centre, seen at the depth of the centre, because the
  // content lies around it.
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

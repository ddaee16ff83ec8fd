#include "client/plan/tile_need.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/price/ask_gain.h"
#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "protocol/impostor/instance_group.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

constexpr double kTexelsPerPixel = 1.5;  // measured: worth more than any filter
// Share of the allowed baseline that a cell may reach.
constexpr double kCellShare = 0.2;
constexpr double kLongestLead = 2;    // s
constexpr double kStillSpeed = 1e-3;  // radii/s

}  // namespace

ViewGeometry view_geometry(const Camera& camera, const InstanceView& instance,
                           const ObjectDescription& object, double time_s) {
  const double scale = instance.world_from_object.scale;
  const glm::dvec3 to_eye = camera.pose.eye - instance.center;
  ViewGeometry view;
  view.focal_px = camera.focal_px();
  view.radius = object.radius;
  view.eye = glm::conjugate(glm::dquat(instance.world_from_object.rotation)) * to_eye / scale;
  view.center_depth = -glm::dot(to_eye, camera.forward()) / scale;
  view.clip_time_s = wrap_clip(time_s + instance.clip_offset_s, object.motion.clip_s);
  view.forward = glm::conjugate(glm::dquat(instance.world_from_object.rotation)) * camera.forward();
  return view;
}

double hole_tolerance(double tau_px, double size_px) {
  const double share = kHoleShare * std::min(1.0, tau_px);
  return std::clamp(share * size_px / tau_px, 1.0, kHoleTolerance);
}

std::uint8_t coarse_class(std::uint8_t size_class) {
  constexpr int kCoarseClasses = 4;  // steps of sqrt 2
  return static_cast<std::uint8_t>(std::max(size_class - kCoarseClasses, 0));
}

double radius_px(const ViewGeometry& view) {
  const double d = glm::length(view.eye);
  return d > view.radius ? view.focal_px * view.radius / tangent_length(d, view.radius)
                         : std::numeric_limits<double>::infinity();
}

double allowed_baseline(const ViewGeometry& view, const ViewPlan& plan) {
  // Depth as if the eye looked at the object: turning the head must not change the key.
  const double r = view.radius;
  const double d = std::max(glm::length(view.eye), limits::kMinCaptureRadii * r * 1.001);
  return plan.tau_px * (d - r) * (d - r) / (view.focal_px * plan.depth_share * r);
}

double expected_life_s(const ViewGeometry& view, const ViewPlan& plan) {
  const double path = (1 + kLeadShare) * allowed_baseline(view, plan);
  return std::clamp(path / std::max(glm::length(plan.velocity), 1e-9), 0.02, kLongestLife);
}

TileNeed need_for_view(const ViewGeometry& view, const ViewPlan& plan) {
  const double r = view.radius, least = limits::kMinCaptureRadii * r * 1.001;
  const double allowed = allowed_baseline(view, plan);
  glm::dvec3 eye = view.eye;
  const double speed = glm::length(plan.velocity);
  if (speed > kStillSpeed * r) {
    const double lead = std::min(kLeadShare * allowed, kLongestLead * speed);
    const glm::dvec3 ahead = eye + plan.velocity * (lead / speed);
    if (glm::length(ahead) > std::max(least, 0.5 * glm::length(eye))) eye = ahead;
  }
  const double d = std::max(glm::length(eye), least);
  const double reach = kCellShare * allowed;
  TileNeed need;
  need.cell =
      *view_cell_from_direction(eye, view_level_for_angle(std::asin(std::min(1.0, reach / d))));
  const double along = std::min(reach * tangent_length(d, r) / r, 0.3 * d);
  int level = 0;
  // A distance is at most half a bucket of 1/2^level octaves from its middle.
  while (level < limits::kMaxDistanceLevel && d * std::expm1(0.34657 / (1 << level)) > along) {
    ++level;
  }
  need.distance = *distance_bucket_from_radii(d / r, level);
  // The tile is sharp at the nearer of the two distances.
  const double dc = radii_from_distance_bucket(need.distance) * r;
  const double nearest = std::min(d, std::max(glm::length(view.eye), least));
  const double half = r / tangent_length(dc, r) * dc;
  const double texels = kTexelsPerPixel * 2.0 * view.focal_px * half / (nearest * plan.pixel_px);
  need.size_class =
      static_cast<std::uint8_t>(std::min(size_class_for(texels * 0.95), kMaxAskedSizeClass));
  return need;
}

}  // namespace mirage

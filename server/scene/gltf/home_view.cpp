#include "server/scene/gltf/home_view.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mirage::gltf {
namespace {

constexpr double kOutside = 2.5;  // eye distance in radii that shows the whole sphere
constexpr double kInside = 0.8;   // the same for a scene to walk in
constexpr std::size_t kManyInstances = 20;
constexpr double kFlat = 0.5;        // height over width
constexpr double kSide = 0.35;       // rise of the eye's direction, where (0.6, 1) is level
constexpr double kAbove = 0.8;       // the same over what has no height
constexpr double kCameraReach = 10;  // radii within which a camera of the file is used
constexpr double kWalkRadius = 1.5;  // in radii
constexpr double kWalkSpeed = 1.4;   // m/s, walking
constexpr double kPersonScale = 5;   // m: in smaller scenes the walk shrinks in proportion
constexpr double kSlowWalk = 0.28;   // radii per second

struct EyeTarget {
  glm::dvec3 eye;
  glm::dvec3 target;
};

std::optional<EyeTarget> camera_view(const Document& document, const NodeTree& tree,
                                     const Bounds& bounds) {
  const double radius = bounds.radius();
  for (const int node : tree.drawn) {
    const int camera = document.model.nodes[node].camera;
    if (camera < 0 || document.model.cameras[camera].type != "perspective") continue;
    const glm::dmat4& world = tree.world_from_node[node];
    const glm::dvec3 forward = -glm::dvec3(world[2]);
    const double length = glm::length(forward);
    if (!is_finite(world) || !(length > 0) || !std::isfinite(length)) continue;
    const glm::dvec3 eye(world[3]);
    const double distance = glm::length(eye - bounds.center());
    if (distance > kCameraReach * radius) continue;
    return EyeTarget{eye, eye + forward / length * std::max(distance, 0.1 * radius)};
  }
  return std::nullopt;
}

bool is_place(const Bounds& bounds, std::size_t instances) {
  const glm::dvec3 size = bounds.high - bounds.low;
  // A flat thing of many parts may be a board or a sign; a place is larger than a room.
  return instances > kManyInstances && bounds.radius() >= kPersonScale &&
         size.y < kFlat * std::max(size.x, size.z);
}

/// From the centre to the eye. What is flat is seen from higher, else it would be a stripe.
glm::dvec3 direction_to_eye(const Bounds& bounds) {
  const glm::dvec3 size = bounds.high - bounds.low;
  const double flat = std::max(0.0, 1 - size.y / (kFlat * std::max(size.x, size.z)));
  return glm::normalize(glm::dvec3(0.6, glm::mix(kSide, kAbove, flat), 1));
}

bool has_extent(const Bounds& bounds) {
  return !bounds.empty && bounds.radius() > 0 && std::isfinite(bounds.radius());
}

}  // namespace

bool is_seen_from_outside(const Document& document, const NodeTree& tree, const Bounds& bounds,
                          std::size_t instances) {
  return has_extent(bounds) && !is_place(bounds, instances) && !camera_view(document, tree, bounds);
}

HomeView import_home_view(const Document& document, const NodeTree& tree, const Bounds& bounds,
                          std::size_t instances) {
  HomeView home;
  const double radius = bounds.radius();
  if (!has_extent(bounds)) return home;
  const bool place = is_place(bounds, instances);
  home.target = bounds.center();
  home.eye = home.target + (place ? kInside * radius * glm::normalize(glm::dvec3(0.6, kSide, 1))
                                  : kOutside * radius * direction_to_eye(bounds));
  if (const auto camera = camera_view(document, tree, bounds)) {
    home.eye = camera->eye;
    home.target = camera->target;
  }
  home.walk_radius_m = kWalkRadius * radius;
  home.walk_speed_mps = radius >= kPersonScale ? kWalkSpeed : kSlowWalk * radius;
  return home;
}

}  // namespace mirage::gltf

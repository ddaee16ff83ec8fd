#include "client/screen/pilot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/scene/scene_view.h"
#include "protocol/base/stable_math.h"

namespace mirage {
namespace {

constexpr double kSteepest = 1.5;       // radians
constexpr double kOrbitAHeight = 3.14;  // radians for a drag over the picture's height
constexpr double kStep = 0.85;          // of the distance that is left, for a step
constexpr double kWalkedStepS = 0.25;   // at full speed, for a step
constexpr double kPannedS = 1;          // distance at which a walker's hand holds the scene
constexpr double kNearest = 1e-3, kFarthest = 20;  // from the pivot, radii of the scene
// A scene is crossed in so many seconds. Who walks takes the scene's own speed as long as that
// crosses it in a time between the other two.
constexpr double kCrossS = 10, kShortestWalkS = 5, kLongestWalkS = 180;
constexpr double kSprint = 2;  // full speed, in walking speeds of the scene
// A flyer has the usual speed where they look at something this far away, s at that speed. The pace
// follows that distance within these limits: close to a thing one goes slowly, and a scene is
// still crossed in at most twice its time. It follows within about `kPaceS`, so that no gap between
// two trees jerks.
constexpr double kUsualAheadS = 5, kSlowest = 0.5, kFastest = 10, kPaceS = 0.5;

/// Turns the direction about the world's vertical, then raises or lowers it.
glm::dvec3 turned(const glm::dvec3& forward, const glm::dvec2& angles) {
  const double c = std::cos(angles.x), s = std::sin(angles.x);
  const glm::dvec3 flat =
      safe_normalize({c * forward.x - s * forward.z, 0, s * forward.x + c * forward.z});
  const double up =
      std::clamp(std::asin(std::clamp(forward.y, -1.0, 1.0)) - angles.y, -kSteepest, kSteepest);
  return flat * std::cos(up) + glm::dvec3(0, std::sin(up), 0);
}

/// Returns where the eye goes: where it looks, or the same along the ground.
glm::dvec3 ahead_of(const Pose& pose, bool along_ground) {
  const glm::dvec3 ahead = glm::dquat(pose.rotation) * glm::dvec3(0, 0, -1);
  return along_ground ? safe_normalize({ahead.x, 0, ahead.z}) : ahead;
}

bool finite(const Steering& by) {
  const double all = by.drag.x + by.drag.y + by.turn.x + by.turn.y + by.move.x + by.move.y +
                     by.move.z + by.pan.x + by.pan.y + by.zoom;
  return std::isfinite(all);
}

/// Returns the distance, in units of `direction`, at which the ray enters the instance's hull; < 0:
/// it misses, or begins inside.
double entry(const ObjectDescription& object, const Similarity& at, const glm::dvec3& eye,
             const glm::dvec3& direction) {
  const glm::dquat inverse = glm::conjugate(glm::dquat(at.rotation));
  const glm::dvec3 origin = inverse * (eye - at.position) / double{at.scale};
  const std::vector<Plane> planes = object.hull.vertices.empty()
                                        ? box_planes(object.box_min, object.box_max)
                                        : object.hull.planes();
  const double t = ray_entry(planes, origin, inverse * direction / double{at.scale});
  return t > 0 ? t : -1;
}

}  // namespace

void Pilot::meet(const SceneView& scene) {
  const HomeView& home = scene.home;
  pivot_ = home.target;
  radius_ = scene.bounds_radius > 0 ? scene.bounds_radius : 1;
  const double away = glm::length(home.eye - scene.bounds_center);
  const bool outside = !home.fit.empty() || away > radius_;
  mode_ = outside ? SteerMode::kOrbit : SteerMode::kWalk;
  ground_here_ = scene.home.walk_eye_m > 0;
  pace_ = wanted_pace_ = 1;
  usual_mps_ = kSprint * home.walk_speed_mps;
  const double seconds = 2 * radius_ / usual_mps_;
  const bool walked = seconds >= kShortestWalkS && seconds <= kLongestWalkS;
  if (mode_ == SteerMode::kOrbit || !walked) usual_mps_ = 2 * radius_ / kCrossS;
}

void Pilot::turn(const glm::dvec2& angles, Pose& pose) const {
  if (angles.x == 0 && angles.y == 0) return;
  const glm::dquat before(pose.rotation);
  const Pose after = look_at(pose.eye, pose.eye + turned(before * glm::dvec3(0, 0, -1), angles));
  pose.rotation = after.rotation;
  if (mode_ == SteerMode::kWalk) return;
  const glm::dquat way = glm::dquat(pose.rotation) * glm::conjugate(before);
  pose.eye = pivot_ + glm::normalize(way) * (pose.eye - pivot_);
}

void Pilot::approach(double steps, Pose& pose) const {
  if (steps == 0) return;
  if (mode_ == SteerMode::kWalk) {
    pose.eye += steps * kWalkedStepS * speed_mps() * ahead_of(pose, on_foot());
    return;
  }
  const double distance = glm::length(pose.eye - pivot_);
  if (!(distance > 0)) return;
  const double wanted = std::clamp(distance * std::pow(kStep, steps), kNearest * radius_,
                                   std::max(distance, kFarthest * radius_));
  pose.eye = pivot_ + (pose.eye - pivot_) * (wanted / distance);
}

void Pilot::go(const Steering& by, double fov_y, Pose& pose) const {
  const bool orbits = mode_ == SteerMode::kOrbit;
  const glm::dquat q(pose.rotation);
  const glm::dvec3 right = q * glm::dvec3(1, 0, 0), up = q * glm::dvec3(0, 1, 0),
                   ahead = ahead_of(pose, on_foot());
  const double depth = orbits ? std::max(glm::dot(pivot_ - pose.eye, ahead), kNearest * radius_)
                              : kPannedS * speed_mps();
  const double height = 2 * depth * std::tan(fov_y / 2);
  pose.eye += height * (by.pan.y * up - by.pan.x * right);
  pose.eye += speed_mps() * (by.move.z * ahead + by.move.x * right + glm::dvec3(0, by.move.y, 0));
}

void Pilot::look_ahead(const SceneView& scene, const Camera& camera) {
  const std::optional<Seen> seen = seen_at(scene, camera, {0.5, 0.5});
  wanted_pace_ = 1;
  if (!seen) return;
  const double seconds = glm::length(seen->point - camera.pose.eye) / usual_mps_;
  // A place that is walked has a speed of its own, also close to a wall.
  wanted_pace_ = std::clamp(seconds / kUsualAheadS, ground_here_ ? 1 : kSlowest, kFastest);
}

void Pilot::change_pace(double seconds) {
  pace_ += (wanted_pace_ - pace_) * (1 - std::exp(-seconds / kPaceS));
}

void Pilot::steer(const Steering& by, double fov_y, const GroundMap& ground, Pose& pose) {
  if (!finite(by)) return;
  const bool orbits = mode_ == SteerMode::kOrbit;
  turn(by.turn + (orbits ? kOrbitAHeight : -fov_y) * by.drag, pose);
  const glm::dvec3 from = pose.eye;
  change_pace(glm::length(by.move) + kWalkedStepS * std::abs(by.zoom));
  approach(by.zoom, pose);
  go(by, fov_y, pose);
  if (needs_ground()) pose.eye = footing_.walk(ground, from, pose.eye - from);
}

std::optional<Seen> seen_at(const SceneView& scene, const Camera& camera, const glm::dvec2& place) {
  const double half = std::tan(camera.fov_y / 2);
  const double aspect = 1.0 * camera.width / std::max(camera.height, 1u);
  const glm::dvec3 direction =
      glm::dquat(camera.pose.rotation) *
      glm::normalize(glm::dvec3((2 * place.x - 1) * half * aspect, (1 - 2 * place.y) * half, -1));
  const glm::dvec3& eye = camera.pose.eye;
  double nearest = std::numeric_limits<double>::infinity();
  std::uint32_t found = 0;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const InstanceView& instance = scene.instances[i];
    const ObjectDescription& object = scene.objects[instance.object];
    const glm::dvec3 to = instance.center - eye;
    const double along = glm::dot(to, direction);
    const double beside2 = glm::dot(to, to) - along * along;
    if (object.group || object.part || beside2 > instance.radius * instance.radius) continue;
    if (along + instance.radius < 0 || along - instance.radius > nearest) continue;
    const double t = entry(object, instance.world_from_object, eye, direction);
    if (!(t > 0 && t < nearest)) continue;
    nearest = t;
    found = i;
  }
  if (!std::isfinite(nearest)) return std::nullopt;
  return Seen{eye + nearest * direction, found};
}

}  // namespace mirage

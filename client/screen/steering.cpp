#include "client/screen/steering.h"

#include <algorithm>
#include <cmath>

#include "protocol/base/stable_math.h"

namespace mirage {
namespace {

constexpr double kSteepest = 1.5;  // radians

// Turns the direction about the world's vertical, then raises or lowers it.
glm::dvec3 turned(const glm::dvec3& forward, double yaw, double pitch) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  const glm::dvec3 flat =
      safe_normalize({c * forward.x - s * forward.z, 0, s * forward.x + c * forward.z});
  const double up =
      std::clamp(std::asin(std::clamp(forward.y, -1.0, 1.0)) - pitch, -kSteepest, kSteepest);
  return flat * std::cos(up) + glm::dvec3(0, std::sin(up), 0);
}

}  // namespace

void steer(Pose& pose, const Steering& by) {
  const double all = by.yaw + by.pitch + by.move.x + by.move.y + by.move.z;
  if (!std::isfinite(all)) return;
  const glm::dquat q(pose.rotation);
  glm::dvec3 forward = q * glm::dvec3(0, 0, -1);
  const glm::dvec3 right = q * glm::dvec3(1, 0, 0);
  if (by.yaw != 0 || by.pitch != 0) forward = turned(forward, by.yaw, by.pitch);
  const glm::dvec3 eye =
      pose.eye + forward * by.move.z + right * by.move.x + glm::dvec3(0, by.move.y, 0);
  pose = look_at(eye, eye + forward);
}

}  // namespace mirage

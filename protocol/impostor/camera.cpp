#include "protocol/impostor/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "protocol/base/stable_math.h"
#include "protocol/model/scene_types.h"

namespace mirage {

double clip_scale(double z) { return std::scalbn(1.0, -std::ilogb(z)); }

void Camera::fit_depth_range(const glm::dvec3& scene_center, double scene_radius) {
  const double reach = glm::length(scene_center - pose.eye) + scene_radius;
  far_m = (reach > 0 ? reach : 1e-6) * 1.01;
  // The near plane stays within the range of float for any scene size.
  near_m = std::max(far_m * 2e-13, std::min(far_m * 2e-4, 1e-36));
}

double Camera::focal_px() const { return 0.5 * height / std::tan(0.5 * fov_y); }
glm::dvec3 Camera::forward() const { return glm::dquat(pose.rotation) * glm::dvec3(0, 0, -1); }
glm::dvec3 Camera::right() const { return glm::dquat(pose.rotation) * glm::dvec3(1, 0, 0); }
glm::dvec3 Camera::up() const { return glm::dquat(pose.rotation) * glm::dvec3(0, 1, 0); }

double Camera::near_for(DepthMapping mapping) const {
  // 1:5,000 keeps 24 bits of depth finer than a pixel of parallax at any distance that matters.
  return mapping == DepthMapping::kReversed ? near_m : std::max(near_m, far_m * 2e-4);
}

glm::dvec2 Camera::window_depth(DepthMapping mapping) const {
  const double n = near_for(mapping), f = far_m;
  if (mapping == DepthMapping::kReversed) return {0.0, n};
  return {f / (f - n), -f * n / (f - n)};
}

glm::mat4 Camera::clip_from_relative(DepthMapping mapping) const {
  const double aspect = static_cast<double>(width) / height;
  glm::dmat4 clip_from_view = glm::perspective(fov_y, aspect, near_for(mapping), far_m);
  if (mapping == DepthMapping::kReversed) {
    clip_from_view[2][2] = 0;
    clip_from_view[3][2] = near_m;
  }
  // The shift adds to x / w and y / w, and w is minus the view's z.
  clip_from_view[2][0] -= 2 * shift_px.x / width;
  clip_from_view[2][1] -= 2 * shift_px.y / height;
  const glm::dmat4 view_from_relative =
      glm::transpose(glm::dmat4(glm::mat4_cast(glm::dquat(pose.rotation))));
  return glm::mat4(clip_scale(far_m) * clip_from_view * view_from_relative);
}

glm::dvec3 Camera::pixel_from_relative(const glm::dvec3& relative) const {
  const double z = glm::dot(relative, forward());
  const double f = focal_px();
  return {0.5 * width + f * glm::dot(relative, right()) / z,
          0.5 * height - f * glm::dot(relative, up()) / z, z};
}

Frustum::Side Frustum::side(double half_angle) {
  return {half_angle >= 1.5707963, std::cos(half_angle), std::sin(half_angle)};
}

Frustum::Frustum(const Camera& camera, double guard)
    : forward_(camera.forward()),
      right_(camera.right()),
      up_(camera.up()),
      across_(side(std::atan(std::tan(0.5 * camera.fov_y) * camera.width / camera.height) + guard)),
      along_(side(0.5 * camera.fov_y + guard)) {}

bool Frustum::may_see(const glm::dvec3& center, double radius) const {
  if (!(glm::length(center) > radius)) return true;
  const double z = glm::dot(center, forward_);
  const auto outside = [&](double off_axis, const Side& side) {
    if (side.open) return false;
    return std::abs(off_axis) * side.cosine - z * side.sine > radius;
  };
  return !outside(glm::dot(center, right_), across_) && !outside(glm::dot(center, up_), along_);
}

Pose look_at(const glm::dvec3& eye, const glm::dvec3& target) {
  glm::dvec3 forward = safe_normalize(target - eye);
  if (forward == glm::dvec3(0)) forward = glm::dvec3(0, 0, -1);
  const bool upright = forward.x * forward.x + forward.z * forward.z > 1e-12;
  const glm::dvec3 hint = upright ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, hint));
  const glm::dmat3 world_from_camera(right, glm::cross(right, forward), -forward);
  return {eye, glm::quat(glm::normalize(glm::quat_cast(world_from_camera)))};
}

Pose home_pose(const HomeView& home, const Camera& camera) {
  constexpr double kFill = 0.8;     // share of the picture's width or height
  constexpr double kNearest = 1.8;  // half diagonals: nearer, perspective distorts what is long
  Pose pose = look_at(home.eye, home.target);
  if (home.fit.empty()) return pose;
  const double high = kFill * std::tan(0.5 * camera.fov_y);
  const glm::dvec2 half(high * camera.width / camera.height, high);
  // A point (x, z) of the view, z towards the eye, is within the picture's right edge if
  // x + half z <= middle + half distance, and likewise at the other edges.
  const glm::dquat view_from_world = glm::conjugate(glm::dquat(pose.rotation));
  glm::dvec2 right(-std::numeric_limits<double>::infinity()), left = right;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), top = -low;
  for (const glm::vec3& point : home.fit) {
    const glm::dvec3 p = view_from_world * glm::dvec3(point);
    right = glm::max(right, glm::dvec2(p) + half * p.z);
    left = glm::max(left, half * p.z - glm::dvec2(p));
    low = glm::min(low, p);
    top = glm::max(top, p);
  }
  const glm::dvec2 middle = 0.5 * (right - left), distances = 0.5 * (right + left) / half;
  const double distance =
      std::max({distances.x, distances.y, kNearest * 0.5 * glm::length(top - low)});
  if (!(distance > 0) || !std::isfinite(distance + middle.x + middle.y)) return pose;
  pose.eye = home.target + glm::dquat(pose.rotation) * glm::dvec3(middle, distance);
  return pose;
}

}  // namespace mirage

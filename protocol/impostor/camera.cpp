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

double Camera::focal_px() const {
  return 0.5 * height / std::tan(0.5 * fov_y) * std::max(1.0, 1 / pixel_aspect);
}

glm::dvec2 Camera::half_tangents() const {
  const double up = std::tan(0.5 * fov_y);
  return {up * width / height * pixel_aspect, up};
}

Camera Camera::at_size(std::uint32_t other_width, std::uint32_t other_height) const {
  Camera other = *this;
  other.width = other_width;
  other.height = other_height;
  other.shift_px *= glm::dvec2(other_width, other_height) / glm::dvec2(width, height);
  return other;
}

Camera Camera::enclosing() const {
  if (shift_px == glm::dvec2(0) && pixel_aspect == 1) return *this;
  const glm::dvec2 size(width, height);
  const glm::dvec2 tangents = half_tangents() * (1.0 + 2.0 * glm::abs(shift_px) / size);
  const glm::dvec2 edges = glm::min(glm::ceil(2.0 * focal_px() * tangents), glm::dvec2(1e9));
  Camera whole = *this;
  whole.shift_px = glm::dvec2(0);
  whole.pixel_aspect = 1;
  whole.width = static_cast<std::uint32_t>(edges.x);
  whole.height = static_cast<std::uint32_t>(edges.y);
  whole.fov_y = 2 * std::atan(0.5 * edges.y / focal_px());
  return whole;
}

bool set_tangents(Camera& camera, const ViewTangents& tangents) {
  constexpr double kNothingPx = 1e-3;  // a matrix of floats is no nearer to its angles
  const glm::dvec2 size(camera.width, camera.height);
  const glm::dvec2 most(tangents.right, tangents.up), least(tangents.left, tangents.down);
  const glm::dvec2 seen = most - least;
  if (!(seen.x > 0 && seen.y > 0 && size.x > 0 && size.y > 0)) return false;
  Camera out = camera;
  out.fov_y = 2 * std::atan(0.5 * seen.y);
  out.pixel_aspect = (seen.x / size.x) / (seen.y / size.y);
  out.shift_px = -0.5 * (most + least) / seen * size;
  if (std::abs(out.pixel_aspect - 1) * std::max(size.x, size.y) < kNothingPx) out.pixel_aspect = 1;
  if (glm::length(out.shift_px) < kNothingPx) out.shift_px = glm::dvec2(0);
  const glm::dvec2 shift = out.shift_px;
  const bool finite = std::isfinite(shift.x) && std::isfinite(shift.y) && out.pixel_aspect > 0 &&
                      std::isfinite(out.pixel_aspect);
  if (finite) camera = out;
  return finite;
}
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
  const double aspect = static_cast<double>(width) / height * pixel_aspect;
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
  const glm::dvec2 f = 0.5 * glm::dvec2(width, height) / half_tangents();
  return {0.5 * width + shift_px.x + f.x * glm::dot(relative, right()) / z,
          0.5 * height - shift_px.y - f.y * glm::dot(relative, up()) / z, z};
}

Frustum::Side Frustum::side(double angle) {
  return {angle >= 1.5707963, std::cos(angle), std::sin(angle)};
}

Frustum::Frustum(const Camera& camera, double guard)
    : forward_(camera.forward()), right_(camera.right()), up_(camera.up()) {
  const glm::dvec2 half = camera.half_tangents();
  const glm::dvec2 shift = 2.0 * camera.shift_px / glm::dvec2(camera.width, camera.height);
  const auto edge = [&](double tangent) { return side(std::atan(tangent) + guard); };
  to_right_ = edge(half.x * (1 - shift.x));
  to_left_ = edge(half.x * (1 + shift.x));
  upward_ = edge(half.y * (1 - shift.y));
  downward_ = edge(half.y * (1 + shift.y));
}

bool Frustum::may_see(const glm::dvec3& center, double radius) const {
  if (!(glm::length(center) > radius)) return true;
  const double z = glm::dot(center, forward_);
  const auto outside = [&](double off_axis, const Side& side) {
    return !side.open && off_axis * side.cosine - z * side.sine > radius;
  };
  const double x = glm::dot(center, right_), y = glm::dot(center, up_);
  return !outside(x, to_right_) && !outside(-x, to_left_) && !outside(y, upward_) &&
         !outside(-y, downward_);
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
  constexpr double kNearest = 1.2;  // half diagonals: nearer, perspective distorts what is long
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

#include "server/scene/motion_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "protocol/limits.h"

namespace mirage {
namespace {

constexpr std::size_t kSegments = limits::kMotionSegments;
constexpr std::size_t kVertexPoses = 16u << 20;  // what one object may cost, about a second
constexpr std::size_t kMaxStepsPerSegment = 8;
constexpr std::size_t kMaxKeyPoses = 2048;
constexpr double kJumpGap = 1e-9;        // s before a STEP key that shows the pose it ends
constexpr double kSpeedMargin = 1.02;    // for what lies between two poses
constexpr double kStill = 1e-6;          // of the extent: rounding of the poses, no motion

std::vector<glm::dvec3> hull_directions() {
  std::vector<glm::dvec3> out;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) out.push_back(glm::normalize(glm::dvec3(x, y, z)));
      }
    }
  }
  return out;
}

std::vector<double> pose_times(const Animation& animation, std::size_t vertices) {
  const double clip = animation.clip_s;
  const std::size_t per_segment =
      std::clamp<std::size_t>(kVertexPoses / std::max<std::size_t>(vertices, 1) / kSegments, 1,
                              kMaxStepsPerSegment);
  std::vector<double> times;
  const std::size_t steps = kSegments * per_segment;
  for (std::size_t i = 0; i < steps; ++i) {
    times.push_back(clip * static_cast<double>(i) / static_cast<double>(steps));
  }
  std::vector<double> keys;
  for (const Channel& c : animation.channels) {
    for (const float t : c.times) {
      if (t > 0 && t < clip) keys.push_back(t);
      if (t > 0 && t < clip && c.interpolation == Interpolation::kStep) {
        keys.push_back(t - kJumpGap);
      }
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  const std::size_t affordable = kVertexPoses / std::max<std::size_t>(vertices, 1);
  if (keys.size() <= std::min(kMaxKeyPoses, std::max(affordable, kSegments))) {
    times.insert(times.end(), keys.begin(), keys.end());
  }
  times.push_back(clip * (1 - 1e-12));
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// Bind-space vertices that anything draws, with an animation of their own.
std::vector<std::uint32_t> used_vertices(const Mesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const std::uint32_t i : mesh.indices) used[i] = true;
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (used[i]) out.push_back(i);
  }
  return out;
}

double largest_step(const std::vector<std::uint32_t>& used, const std::vector<glm::vec3>& a,
                    const std::vector<glm::vec3>& b) {
  float most = 0;
  for (const std::uint32_t i : used) {
    const glm::vec3 d = b[i] - a[i];
    most = std::max(most, glm::dot(d, d));
  }
  return std::sqrt(double{most});
}

/// The extremes of everything that is added.
struct Extent {
  std::vector<glm::dvec3> directions = hull_directions();
  std::vector<double> support =
      std::vector<double>(26, -std::numeric_limits<double>::infinity());
  std::vector<glm::dvec3> point = std::vector<glm::dvec3>(26);
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};

  void add(const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const double d = glm::dot(directions[i], glm::dvec3(p));
      if (d <= support[i]) continue;
      support[i] = d;
      point[i] = p;
    }
  }
};

MotionProfile profile(const std::vector<double>& times, const std::vector<double>& steps,
                      double clip_s, double wrap_jump) {
  MotionProfile motion;
  motion.clip_s = static_cast<float>(clip_s);
  motion.wrap_jump = static_cast<float>(wrap_jump * (1 + 1e-6));
  motion.speed.assign(kSegments, 0.0f);
  std::vector<float> jumps(std::size_t{1} << limits::kMaxPhaseLevel, 0.0f);
  const auto is_jump = [&](std::size_t i) { return times[i + 1] - times[i] < 2 * kJumpGap; };
  const auto speed_of = [&](std::size_t i) {
    return is_jump(i) ? 0.0 : steps[i] / (times[i + 1] - times[i]);
  };
  bool any_jump = false;
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const double share = times[i] / clip_s;
    const auto segment =
        std::min(static_cast<std::size_t>(share * kSegments * (1 + 1e-12)), kSegments - 1);
    if (is_jump(i)) {
      const auto part = static_cast<std::size_t>(share * static_cast<double>(jumps.size()));
      jumps[std::min(part, jumps.size() - 1)] += static_cast<float>(steps[i] * (1 + 1e-6));
      any_jump = any_jump || steps[i] > 0;
      continue;
    }
    double speed = speed_of(i);
    if (i > 0) speed = std::max(speed, speed_of(i - 1));
    if (i + 2 < times.size()) speed = std::max(speed, speed_of(i + 1));
    motion.speed[segment] =
        std::max(motion.speed[segment], static_cast<float>(speed * kSpeedMargin));
  }
  if (any_jump) motion.jump = jumps;
  return motion;
}

}  // namespace

MeasuredMotion measure_motion(const Mesh& mesh, const Animation& animation) {
  MeasuredMotion out;
  const std::vector<std::uint32_t> used = used_vertices(mesh);
  if (used.empty()) return out;
  const std::vector<double> times = pose_times(animation, mesh.vertices.size());
  std::vector<glm::vec3> first, last, now;
  std::vector<double> steps;
  Extent extent;
  double growth = 0;
  pose_positions(mesh.vertices, animation, times.front(), first);
  last = first;
  for (std::size_t k = 0; k < times.size(); ++k) {
    pose_positions(mesh.vertices, animation, times[k], now);
    for (const std::uint32_t i : used) extent.add(now[i]);
    if (k > 0) {
      steps.push_back(largest_step(used, last, now));
      if (times[k] - times[k - 1] >= 2 * kJumpGap) growth = std::max(growth, steps.back());
    }
    std::swap(last, now);
  }
  const double wrap_jump = largest_step(used, last, first);
  const double size = glm::length(glm::dvec3(extent.high) - glm::dvec3(extent.low));
  const double largest = std::max(wrap_jump, *std::max_element(steps.begin(), steps.end()));
  const auto grown = static_cast<float>(growth);
  out.box_min = extent.low - grown;
  out.box_max = extent.high + grown;
  out.center = 0.5f * (out.box_min + out.box_max);
  for (std::size_t i = 0; i < extent.directions.size(); ++i) {
    out.hull_points.emplace_back(extent.point[i] + growth * extent.directions[i]);
  }
  for (const double t : times) {
    pose_positions(mesh.vertices, animation, t, now);
    for (const std::uint32_t i : used) {
      out.radius = std::max(out.radius, glm::length(glm::dvec3(now[i]) - glm::dvec3(out.center)));
    }
  }
  out.radius += growth;
  if (largest > kStill * size) out.motion = profile(times, steps, animation.clip_s, wrap_jump);
  return out;
}

}  // namespace mirage

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
constexpr std::size_t kMaxStepsPerSegment = 4;
constexpr std::size_t kMaxKeyPoses = 1024;
constexpr double kJumpGap = 1e-9;      // s before a STEP key that shows the pose it ends
constexpr double kEven = 0.02;         // halves of a step that differ by less are one speed
constexpr double kSpeedMargin = 1.05;  // for what lies between two poses of even speed
constexpr double kUnevenMargin = 2;    // and where halving has ended before it got even
constexpr int kMaxHalvings = 8;
constexpr int kCenterPoses = 16;
constexpr double kMatters = 1e-5;  // of the extent: smaller steps are not halved again
constexpr double kStill = 1e-6;    // of the extent: rounding of the poses, no motion

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
  const std::size_t per_segment = std::clamp<std::size_t>(
      kVertexPoses / std::max<std::size_t>(vertices, 1) / kSegments, 1, kMaxStepsPerSegment);
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
  std::vector<double> support = std::vector<double>(26, -std::numeric_limits<double>::infinity());
  std::vector<glm::dvec3> point = std::vector<glm::dvec3>(26);
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};

  glm::vec3 center{0};  ///< any point; where the bounding sphere is to be
  double radius2 = 0;   ///< squared, around it

  void add(const glm::vec3& p) {
    const glm::dvec3 off = glm::dvec3(p) - glm::dvec3(center);
    radius2 = std::max(radius2, glm::dot(off, off));
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

/// One part of the clip over which the largest speed is even.
struct Step {
  double from = 0, to = 0;
  double distance = 0;
  double margin = kSpeedMargin;
  bool is_jump() const { return to - from < 2 * kJumpGap; }
};

/// Walks the clip pose by pose. A part whose halves differ in speed is halved again.
class Walk {
 public:
  Walk(const Mesh& mesh, const Animation& animation)
      : mesh_(mesh), animation_(animation), used_(used_vertices(mesh)) {}

  void run(const std::vector<double>& times) {
    Points points;
    glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    for (int i = 0; i < kCenterPoses; ++i) {
      pose_positions(mesh_.vertices, animation_, i * double{animation_.clip_s} / kCenterPoses,
                     points);
      for (const std::uint32_t k : used_) {
        low = glm::min(low, points[k]);
        high = glm::max(high, points[k]);
      }
    }
    extent_.center = 0.5f * (low + high);
    first_ = at(times.front());
    std::vector<glm::vec3> last = first_;
    for (std::size_t k = 1; k < times.size(); ++k) {
      std::vector<glm::vec3> now = at(times[k]);
      split({times[k - 1], times[k], distance(last, now), kSpeedMargin}, last, now, 0);
      last = std::move(now);
    }
    wrap_jump_ = distance(last, first_);
  }

  const std::vector<std::uint32_t>& used() const { return used_; }
  const std::vector<Step>& steps() const { return steps_; }
  const Extent& extent() const { return extent_; }
  double wrap_jump() const { return wrap_jump_; }

 private:
  using Points = std::vector<glm::vec3>;
  double distance(const Points& a, const Points& b) const { return largest_step(used_, a, b); }
  Points at(double t) {
    Points out;
    pose_positions(mesh_.vertices, animation_, t, out);
    for (const std::uint32_t i : used_) extent_.add(out[i]);
    return out;
  }
  void split(const Step& whole, const Points& a, const Points& b, int depth) {
    if (whole.is_jump()) return steps_.push_back(whole);
    const double middle = 0.5 * (whole.from + whole.to);
    const Points m = at(middle);
    Step halves[2] = {{whole.from, middle, distance(a, m), kSpeedMargin},
                      {middle, whole.to, distance(m, b), kSpeedMargin}};
    const double low = std::min(halves[0].distance, halves[1].distance);
    const double high = std::max(halves[0].distance, halves[1].distance);
    const bool even = high - low <= kEven * high && 2 * high <= (1 + kEven) * whole.distance;
    const bool matters = high > kMatters * glm::length(extent_.high - extent_.low);
    if (!even && matters && depth < kMaxHalvings) {
      split(halves[0], a, m, depth + 1);
      split(halves[1], m, b, depth + 1);
      return;
    }
    for (Step& half : halves) {
      half.distance = even ? half.distance : high;
      half.margin = even ? kSpeedMargin : kUnevenMargin;
      steps_.push_back(half);
    }
  }

  const Mesh& mesh_;
  const Animation& animation_;
  const std::vector<std::uint32_t> used_;
  Points first_;
  Extent extent_;
  std::vector<Step> steps_;
  double wrap_jump_ = 0;
};

MotionProfile profile(const std::vector<Step>& steps, double clip_s, double wrap_jump) {
  MotionProfile motion;
  motion.clip_s = static_cast<float>(clip_s);
  motion.wrap_jump = static_cast<float>(wrap_jump * (1 + 1e-6));
  motion.speed.assign(kSegments, 0.0f);
  std::vector<float> jumps(std::size_t{1} << limits::kMaxPhaseLevel, 0.0f);
  bool any_jump = false;
  for (const Step& step : steps) {
    const double share = step.from / clip_s;
    if (step.is_jump()) {
      const auto part = static_cast<std::size_t>(share * static_cast<double>(jumps.size()));
      jumps[std::min(part, jumps.size() - 1)] += static_cast<float>(step.distance * (1 + 1e-6));
      any_jump = any_jump || step.distance > 0;
      continue;
    }
    const auto segment =
        std::min(static_cast<std::size_t>(share * kSegments * (1 + 1e-12)), kSegments - 1);
    const double speed = step.margin * step.distance / (step.to - step.from);
    motion.speed[segment] = std::max(motion.speed[segment], static_cast<float>(speed));
  }
  if (any_jump) motion.jump = jumps;
  return motion;
}

}  // namespace

MeasuredMotion measure_motion(const Mesh& mesh, const Animation& animation) {
  MeasuredMotion out;
  Walk walk(mesh, animation);
  if (walk.used().empty()) return out;
  walk.run(pose_times(animation, mesh.vertices.size()));
  double growth = 0, largest = walk.wrap_jump();
  for (const Step& step : walk.steps()) {
    largest = std::max(largest, step.distance);
    if (!step.is_jump()) growth = std::max(growth, step.distance);
  }
  const Extent& extent = walk.extent();
  const auto grown = static_cast<float>(growth);
  out.box_min = extent.low - grown;
  out.box_max = extent.high + grown;
  out.center = extent.center;
  for (std::size_t i = 0; i < extent.directions.size(); ++i) {
    out.hull_points.emplace_back(extent.point[i] + growth * extent.directions[i]);
  }
  out.radius = std::sqrt(extent.radius2) + growth;
  const double size = glm::length(glm::dvec3(extent.high) - glm::dvec3(extent.low));
  if (largest > kStill * size) {
    out.motion = profile(walk.steps(), animation.clip_s, walk.wrap_jump());
  }
  return out;
}

}  // namespace mirage

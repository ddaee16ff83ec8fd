#include "server/prepare/motion_measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "protocol/base/limits.h"
#include "server/prepare/convex_hull.h"
#include "server/prepare/posed_extent.h"

namespace mirage {
namespace {

constexpr std::size_t kSegments = limits::kMotionSegments;
// vertices times poses of one object, at most; about a second
constexpr std::size_t kVertexPoses = 16u << 20;
// Above it, rigid parts are measured by a body around each, a few per cent larger.
constexpr std::size_t kManyVertices = 1u << 17;
constexpr std::size_t kMaxStepsPerSegment = 4;
constexpr std::size_t kMaxKeyPoses = 1024;
constexpr double kJumpGap = 1e-9;      // s before a STEP key; shows the pose that the key ends
constexpr double kEven = 0.02;         // halves of a step that differ by less have one speed
constexpr double kSpeedMargin = 1.05;  // for the motion between two poses of even speed
constexpr double kUnevenMargin = 2;    // for steps that are still uneven after all halvings
constexpr int kMaxHalvings = 8;
constexpr int kCenterPoses = 16;
constexpr double kMatters = 1e-5;  // of the extent: smaller steps are not halved
constexpr double kStill = 1e-6;    // of the extent: smaller motion is rounding of the poses

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

/// Returns the indices of the vertices that primitives use.
std::vector<std::uint32_t> used_vertices(const Mesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const std::uint32_t i : mesh.indices) used[i] = true;
  std::vector<std::uint32_t> out;
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (used[i]) out.push_back(i);
  }
  return out;
}

/// A part of the clip with an even largest speed.
struct Step {
  double from = 0, to = 0;
  double distance = 0;
  double margin = kSpeedMargin;
  bool is_jump() const { return to - from < 2 * kJumpGap; }
};

/// Returns the corners of a convex body around some points: those of its hull in 26 directions, or
/// of its box.
std::vector<glm::vec3> corners_around(const std::vector<glm::vec3>& points) {
  if (const Result<ConvexHull> hull = enclosing_hull(points)) return hull->vertices;
  PointBox box;
  box.add(points);
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back((i & 1 ? box.high : box.low).x, (i & 2 ? box.high : box.low).y,
                         (i & 4 ? box.high : box.low).z);
  }
  return corners;
}

/// A mesh and its animation, as far as they are measured.
struct Measured {
  Mesh mesh;
  Animation animation;
};

/// Returns the corners around the vertices of each joint. How far a pose moves a point away from
/// another pose of it is a convex function of the point, so that a body moves farthest at corners.
Measured corners_of_rigid_parts(const Mesh& mesh, const Animation& animation,
                                const std::vector<std::uint32_t>& used) {
  std::map<std::uint16_t, std::vector<glm::vec3>> parts;
  for (const std::uint32_t i : used) {
    parts[animation.vertices[i].binding.x].push_back(mesh.vertices[i].position);
  }
  Measured out;
  out.animation = animation;
  out.animation.vertices.clear();
  for (const auto& [binding, points] : parts) {
    for (const glm::vec3& corner : corners_around(points)) {
      out.mesh.indices.push_back(static_cast<std::uint32_t>(out.mesh.vertices.size()));
      out.mesh.vertices.emplace_back().position = corner;
      out.animation.vertices.emplace_back().binding.x = binding;
    }
  }
  return out;
}

using Points = std::vector<glm::vec3>;

/// Walks the clip pose by pose and halves each part whose halves differ in speed.
class Walk {
 public:
  Walk(const Mesh& mesh, const Animation& animation)
      : mesh_(mesh), animation_(animation), used_(used_vertices(mesh)) {}

  void run(const std::vector<double>& times) {
    PointBox box;
    for (int i = 0; i < kCenterPoses; ++i) {
      box.add(posed(i * double{animation_.clip_s} / kCenterPoses));
    }
    extent_.emplace(0.5f * (box.low + box.high));
    first_ = at(times.front());
    Points last = first_;
    for (std::size_t k = 1; k < times.size(); ++k) {
      Points now = at(times[k]);
      split({times[k - 1], times[k], largest_step(last, now), kSpeedMargin}, last, now, 0);
      last = std::move(now);
    }
    wrap_jump_ = largest_step(last, first_);
  }

  const std::vector<std::uint32_t>& used() const { return used_; }
  const std::vector<Step>& steps() const { return steps_; }
  const PosedExtent& extent() const { return *extent_; }
  double wrap_jump() const { return wrap_jump_; }

 private:
  // Returns the positions of the used vertices at a clip time.
  Points posed(double t) const {
    Points out;
    pose_positions(mesh_.vertices, animation_, t, out);
    for (std::size_t i = 0; i < used_.size(); ++i)
      out[i] = out[used_[i]];  // in place: used_ is increasing
    out.resize(used_.size());
    return out;
  }
  Points at(double t) {
    Points out = posed(t);
    extent_->add(out);
    return out;
  }
  void split(const Step& whole, const Points& a, const Points& b, int depth) {
    if (whole.is_jump()) return steps_.push_back(whole);
    const double middle = 0.5 * (whole.from + whole.to);
    const Points m = at(middle);
    Step halves[2] = {{whole.from, middle, largest_step(a, m), kSpeedMargin},
                      {middle, whole.to, largest_step(m, b), kSpeedMargin}};
    const double low = std::min(halves[0].distance, halves[1].distance);
    const double high = std::max(halves[0].distance, halves[1].distance);
    const bool even = high - low <= kEven * high && 2 * high <= (1 + kEven) * whole.distance;
    const bool matters = high > kMatters * glm::length(extent_->box().high - extent_->box().low);
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
  std::optional<PosedExtent> extent_;
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

/// Returns the longest image of an axis.
float size_of(const glm::mat4& m) {
  return std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
}

/// True if the pose draws nothing: no joint leaves its vertices any extent. Something that is
/// hidden by a scale of 0.0001 counts, too.
bool has_no_extent(const AnimationState& state, const std::vector<float>& largest) {
  constexpr float kTiny = 1e-4f;
  for (std::size_t i = 0; i < largest.size(); ++i) {
    if (size_of(state.object_from_bind[i]) > kTiny * largest[i]) return false;
  }
  return true;
}

/// Returns MotionProfile::hidden.
std::vector<std::uint8_t> hidden_poses(const Animation& animation) {
  constexpr std::size_t kPoses = std::size_t{1} << limits::kMaxPhaseLevel;
  std::vector<AnimationState> poses;
  std::vector<float> largest(animation.bindings.size(), 0.0f);
  for (std::size_t p = 0; p < kPoses; ++p) {
    poses.push_back(evaluate(animation, phase_time(static_cast<Phase>(p + 1), animation.clip_s)));
    for (std::size_t i = 0; i < largest.size(); ++i) {
      largest[i] = std::max(largest[i], size_of(poses[p].object_from_bind[i]));
    }
  }
  std::vector<std::uint8_t> hidden(kPoses / 8, 0);
  bool any = false;
  for (std::size_t p = 0; p < kPoses; ++p) {
    if (!has_no_extent(poses[p], largest)) continue;
    hidden[p / 8] = static_cast<std::uint8_t>(hidden[p / 8] | 1 << p % 8);
    any = true;
  }
  return any ? hidden : std::vector<std::uint8_t>();
}

}  // namespace

MeasuredMotion measure_motion(const Mesh& mesh, const Animation& animation, double way) {
  if (mesh.vertices.size() > kManyVertices && moves_rigidly(animation)) {
    const Measured few = corners_of_rigid_parts(mesh, animation, used_vertices(mesh));
    return measure_motion(few.mesh, few.animation, way);
  }
  MeasuredMotion out;
  Walk walk(mesh, animation);
  if (walk.used().empty()) return out;
  walk.run(pose_times(animation, mesh.vertices.size()));
  double growth = 0, largest = walk.wrap_jump();
  for (const Step& step : walk.steps()) {
    largest = std::max(largest, step.distance);
    if (!step.is_jump()) growth = std::max(growth, step.distance);
  }
  const PosedExtent& extent = walk.extent();
  const PointBox& box = extent.box();
  const auto grown = static_cast<float>(growth);
  out.box_min = box.low - grown;
  out.box_max = box.high + grown;
  out.center = extent.center();
  for (std::size_t i = 0; i < PosedExtent::kDirections; ++i) {
    out.hull_points.emplace_back(extent.points()[i] + growth * extent.directions()[i]);
  }
  out.radius = std::sqrt(extent.radius2()) + growth;
  const double size = glm::length(glm::dvec3(box.high) - glm::dvec3(box.low));
  if (largest > kStill * (size + way)) {
    out.motion = profile(walk.steps(), animation.clip_s, walk.wrap_jump());
    out.motion.hidden = hidden_poses(animation);
  }
  return out;
}

}  // namespace mirage

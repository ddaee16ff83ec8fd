#include "server/render/frame_pieces.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <tuple>

#include "protocol/impostor/motion.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"

namespace mirage {
namespace {

// Limits of views, so that every scene's view is fast: instances with a smaller radius in px are
// left out, and all beyond the largest kMostInstances.
constexpr double kLeastPx = 0.5;
constexpr std::ptrdiff_t kMostInstances = 20'000;

constexpr double kPieceSamples = 64 * 1024;
// Margin for lines and points, which are drawn wider than their geometry.
constexpr double kStrokeRows = 2;

bool touches(double low, double high, const RowBand& band) {
  return high >= static_cast<double>(band.low) && low <= static_cast<double>(band.high);
}

// Returns the rows from the bottom that a sphere may touch; `center` is relative to the eye.
std::pair<double, double> rows_of(const Camera& camera, const glm::dvec3& center, double radius) {
  constexpr double kAll = 1e9, kRightAngle = 0.5 * glm::pi<double>();
  const double ahead = glm::dot(center, camera.forward()), above = glm::dot(center, camera.up());
  const double apart = std::hypot(ahead, above);
  if (!(apart > radius)) return {-kAll, kAll};
  const double off_axis = std::atan2(above, ahead), half = std::asin(radius / apart);
  const auto row = [&](double angle, double beyond) {
    if (std::abs(angle) >= kRightAngle) return beyond;
    const double focal = 0.5 * camera.height / camera.half_tangents().y;
    return 0.5 * camera.height + camera.shift_px.y + focal * std::tan(angle);
  };
  return {row(off_axis - half, -kAll) - kStrokeRows, row(off_axis + half, kAll) + kStrokeRows};
}

}  // namespace

std::size_t FramePieces::level_of(const SceneShot& shot, const Visible& one) const {
  const ObjectDescription& object = scene_->prepared->objects[one.object];
  if (shot.whole || shot.level_px <= 0) return 0;  // before levels are made, nobody looks at them
  if (object.lods.empty() || object.motion.moving()) return 0;
  const double scale = scene_->prepared->scene.instances[one.instance].world_from_object.scale;
  const double nearest = std::max(one.distance - object.radius * scale, shot.camera.near_m);
  return lod_for_view(object.lods, shot.camera.focal_px() * scale / nearest, shot.level_px);
}

FramePieces::Visible FramePieces::look_at(const SceneShot& shot, std::uint32_t index,
                                          const Frustum& frustum) const {
  const Instance& instance = scene_->prepared->scene.instances[index];
  const ObjectDescription& object = scene_->prepared->objects[instance.object];
  const double time = wrap_clip(shot.time_s + double{instance.clip_offset_s}, object.track.clip_s);
  const Similarity m = on_track(instance.world_from_object, object.track, time);
  const glm::dvec3 offset = glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale});
  const glm::dvec3 center = m.position - shot.camera.pose.eye + offset;
  const double radius = double{object.radius} * m.scale;
  Visible out;
  out.object = instance.object;
  out.instance = index;
  out.in_view = frustum.may_see(center, radius);
  out.distance = glm::length(center);
  out.size_px = shot.camera.focal_px() * radius / std::max(out.distance - radius, 1e-9);
  std::tie(out.low, out.high) = rows_of(shot.camera, center, radius);
  out.level = level_of(shot, out);
  return out;
}

FramePieces::FramePieces(const GpuScene& scene, const SceneShot& shot)
    : scene_(&scene),
      samples_a_pixel_(double{1} * shot.supersample * shot.supersample),
      samples_a_row_(samples_a_pixel_ * shot.camera.width),
      rows_(shot.camera.height) {
  const PreparedScene& prepared = *scene.prepared;
  const Frustum frustum(shot.camera);
  for (std::uint32_t i = 0; i < prepared.scene.instances.size(); ++i) {
    const Visible one = look_at(shot, i, frustum);
    if (prepared.objects[one.object].needs & kNeedBlend) blended_.push_back(one);
    const bool large_enough = shot.level_px <= 0 || one.size_px >= kLeastPx;
    if (one.in_view && large_enough) opaque_.push_back(one);
  }
  if (shot.level_px > 0 && opaque_.size() > std::size_t{kMostInstances}) {
    std::nth_element(opaque_.begin(), opaque_.begin() + kMostInstances, opaque_.end(),
                     [](const Visible& a, const Visible& b) { return a.size_px > b.size_px; });
    opaque_.resize(kMostInstances);
  }
  std::sort(opaque_.begin(), opaque_.end(), [](const Visible& a, const Visible& b) {
    return std::tie(a.object, a.level, a.instance) < std::tie(b.object, b.level, b.instance);
  });
  std::sort(blended_.begin(), blended_.end(), [](const Visible& a, const Visible& b) {
    return a.distance != b.distance ? a.distance > b.distance : a.instance < b.instance;
  });
}

double FramePieces::work(const Visible& one, const RowBand& band) const {
  const double covered = glm::pi<double>() * one.size_px * one.size_px * samples_a_pixel_;
  return kSamplesPerTriangle * scene_->level(one.object, one.level).triangles() +
         std::min(covered, samples_a_row_ * (band.high - band.low));
}

std::uint32_t FramePieces::rows_of_band(double samples) const {
  double all = 0;
  for (const std::vector<Visible>* list : {&opaque_, &blended_}) {
    for (const Visible& one : *list) {
      all += kSamplesPerTriangle * scene_->level(one.object, one.level).triangles();
    }
  }
  // Averaging a pixel's samples and reading it back takes as long as shading one sample.
  const double pixels_a_row = samples_a_row_ / samples_a_pixel_;
  const double rows = std::max(samples, all) / (samples_a_row_ + pixels_a_row);
  return static_cast<std::uint32_t>(std::clamp(rows, 1.0, double{1} * rows_));
}

std::vector<FramePiece> FramePieces::opaque(const RowBand& band) const {
  std::vector<FramePiece> out;
  const Visible* last = nullptr;  // instance added last to the present piece
  for (const Visible& one : opaque_) {
    if (!touches(one.low, one.high, band)) continue;
    const bool moves = scene_->prepared->objects[one.object].motion.moving();
    const bool joins = last && !moves && last->object == one.object && last->level == one.level &&
                       out.back().work < kPieceSamples;
    if (!joins) out.push_back({one.object, one.level, {}, 0});
    out.back().instances.push_back(one.instance);
    out.back().work += work(one, band);
    last = &one;
  }
  return out;
}

std::vector<FramePiece> FramePieces::blended(const RowBand& band) const {
  std::vector<FramePiece> out;
  for (const Visible& one : blended_) {
    if (!one.in_view || !touches(one.low, one.high, band)) continue;
    out.push_back({one.object, 0, {one.instance}, work(one, band)});
  }
  return out;
}

}  // namespace mirage

#pragma once
// Session stats: what a viewing session measured, and its JSON (the contract of `--stats`).

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "client/draw/geometric_error.h"
#include "client/draw/gpu_bytes.h"
#include "client/hold/upload_counts.h"
#include "client/link/link.h"
#include "client/plan/predictor.h"
#include "client/session/counts.h"
#include "protocol/model/scene_types.h"
#include "protocol/quality/metrics.h"

namespace mirage {

struct DrawList;
class FramePlan;
class FrameRecorder;
struct LinkUse;
class SceneView;
struct TileLife;

class SessionStats {
 public:
  void add_frame(const DrawList& list, int draw_calls, double frame_ms, std::int64_t now_us);
  /// Notes how the frame was planned.
  void note_plan(const FramePlan& plan);
  /// Notes that the last added frame was drawn, not kept, and took `real_ms`.
  void note_drawn(double real_ms) {
    ++drawn_;
    real_ms_.push_back(static_cast<float>(real_ms));
  }
  /// Notes that a frame was expected to take `expected_ms` before it was fitted, and took `ms`.
  void note_price(double expected_ms, double ms) {
    price_errors_.push_back(static_cast<float>(std::abs(expected_ms / ms - 1)));
  }
  /// Adds the light lag of a frame, if the light has ever changed: for each lit impostor, how long
  /// its light has been past.
  void add_light_lag(const DrawList& list, const SceneView& scene);
  void add_comparison(const ImageMeasures& measures);
  /// Adds the E6 flicker of a compared frame whose predecessor was compared as well.
  void add_flicker(std::optional<double> flicker) {
    if (flicker) flicker_.push_back(static_cast<float>(*flicker));
  }
  GeometricError& geometric() { return geometric_; }
  /// Notes the bytes so far, both ways, at a time since the start. The rate counts once the first
  /// seconds are over.
  void note_traffic(const LinkTraffic& traffic, std::int64_t since_start_us) {
    if (since_start_us < kSettleUs || settled_us_ >= 0) return;
    settled_us_ = since_start_us;
    settled_bytes_ = traffic.bytes_down + traffic.bytes_up;
  }
  /// Notes how many tiles have been asked for so far, at a time since the start.
  void note_asked(std::uint64_t tiles, std::int64_t since_start_us) {
    if (tiles != asked_) last_asked_us_ = since_start_us;
    asked_ = tiles;
  }
  /// Counts frames in which a first image waited to be asked for while neither link nor server was
  /// busy.
  void note_use(bool first_waits, const LinkUse& use);
  /// Note the first frame that showed anything of the scene, and the first with an image of an
  /// object.
  void first_picture(std::int64_t now_us) {
    if (first_picture_us_ < 0) first_picture_us_ = now_us;
  }
  void first_image(std::int64_t now_us) {
    if (first_image_us_ < 0) first_image_us_ = now_us;
  }

  /// Notes the graphics memory in use after a frame.
  void note_gpu(const GpuBytes& bytes, std::size_t target) {
    gpu_ = bytes;
    gpu_target_ = target;
    gpu_most_ = std::max(gpu_most_, bytes.all() + target);
  }

  struct Final {
    LinkTraffic traffic;
    TileCounts tiles;
    CodecUses codecs;
    PredictionError prediction;
    UploadCounts uploads;
    ViewCounts views;
    std::size_t atlas_budget = 0, geometry_budget = 0,
                upload_budget = 0;  ///< bytes; upload_budget: a frame
    /// Shader programs compiled: in all, since the scene is known, and within draws.
    std::uint64_t programs = 0, programs_after_scene = 0, programs_in_draws = 0;
    std::int64_t duration_us = 0;
    HomeView home;
    std::string scene, renderer, server, method;
    double tau_px = 1;
    double wall_s = 0;
    int samples = 0;  ///< of a pixel, at the end
  };
  /// Returns all keys of the contract. On virtual time nothing in it depends on the machine.
  std::string json(const Final& end) const;
  /// Returns the figures of the wall clock: frame times and duration. They are separate, so that
  /// the rest is reproducible.
  std::string real_time_json(const Final& end, const FrameRecorder& frames) const;
  /// Returns a short table for people.
  std::string table(const Final& end) const;

 private:
  static constexpr std::int64_t kSettleUs = 5'000'000;
  std::int64_t settled_us_ = -1;
  std::uint64_t settled_bytes_ = 0;
  std::uint64_t asked_ = 0;
  std::int64_t last_asked_us_ = -1;
  std::size_t frames_ = 0, drawn_ = 0;
  std::size_t known_use_ = 0, starved_ = 0;  ///< numbers of frames
  std::int64_t first_image_us_ = -1, first_picture_us_ = -1;
  std::uint64_t planned_ = 0;
  /// Sums, except for the budget.
  double budget_ms_ = 0, scale_ = 0, samples_ = 0, lambda_ = 0, expected_flip_ = 0;
  std::vector<float> frame_ms_, real_ms_, price_errors_, bounds_, ages_ms_, light_lag_ms_;
  std::uint64_t relit_ = 0;
  std::uint64_t visible_ = 0, over_tau_ = 0, stale_ = 0, placeholders_ = 0, impostors_ = 0,
                meshes_ = 0, draw_calls_ = 0;
  int most_draw_calls_ = 0;
  GpuBytes gpu_;
  std::size_t gpu_target_ = 0, gpu_most_ = 0;
  std::vector<float> flip_, flip_p99_, flicker_;
  std::vector<float> psnr_all_, ssim_all_, iou_all_;
  GeometricError geometric_;
};

/// Returns the life of every tile and the stages of every frame as JSON, for `--trace`.
std::string trace_json(const std::vector<TileLife>& lives, const FrameRecorder& frames);

}  // namespace mirage

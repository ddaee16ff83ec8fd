#include "client/view/session_stats.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "client/frame/draw_list.h"
#include "client/hold/tile_cache.h"
#include "client/host/frame_recorder.h"
#include "client/link/modelled_link.h"
#include "client/plan/frame_plan.h"
#include "client/scene/scene_view.h"
#include "client/session/tile_trace.h"
#include "protocol/base/quantile.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

using nlohmann::ordered_json;

// JSON has no infinity, so a value that cannot be measured or bounded is null.
ordered_json number(double v) { return std::isfinite(v) ? ordered_json(v) : ordered_json(nullptr); }

ordered_json quantiles(const std::vector<float>& values, bool with_max) {
  ordered_json out;
  out["p50"] = number(quantile(values, 0.50));
  out["p95"] = number(quantile(values, 0.95));
  out["p99"] = number(quantile(values, 0.99));
  if (with_max) out["max"] = number(quantile(values, 1.0));
  return out;
}

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

// Identical images have an infinite PSNR. It is left out of the mean, as numerics.md section 1
// requires.
ordered_json mean_min(const std::vector<float>& values) {
  double sum = 0, least = INFINITY;
  std::size_t n = 0;
  for (const float v : values) {
    if (!std::isfinite(v)) continue;
    sum += v;
    least = std::min(least, static_cast<double>(v));
    ++n;
  }
  ordered_json out;
  out["mean"] = n > 0 ? ordered_json(sum / static_cast<double>(n)) : ordered_json(nullptr);
  out["min"] = n > 0 ? ordered_json(least) : ordered_json(nullptr);
  return out;
}

// Returns the tiles that came in each codec used, and the errors of the lossy ones on covered
// colours (1/255): the RMS over a tile, as quantiles over tiles, and the largest of any texel.
ordered_json codecs_json(const CodecUses& uses) {
  ordered_json out = ordered_json::object();
  for (const TileCodec codec : kTileCodecs) {
    const CodecUse& use = uses[static_cast<std::size_t>(codec)];
    if (use.tiles == 0) continue;
    ordered_json& one = out[codec_name(codec)];
    one = {{"tiles", use.tiles}, {"bytes", use.bytes}};
    if (!is_lossy(codec)) continue;
    one["color_error"] = {{"p50", number(quantile(use.color_rms, 0.50))},
                          {"p95", number(quantile(use.color_rms, 0.95))},
                          {"max", use.color_max}};
  }
  return out;
}

double mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += v;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace

void SessionStats::add_frame(const DrawList& list, int draw_calls, double frame_ms,
                             std::int64_t now_us) {
  ++frames_;
  frame_ms_.push_back(static_cast<float>(frame_ms));
  draw_calls_ += static_cast<std::uint64_t>(draw_calls);
  most_draw_calls_ = std::max(most_draw_calls_, draw_calls);
  visible_ += list.visible;
  over_tau_ += list.over_tau;
  placeholders_ += list.placeholders.size();
  impostors_ += list.impostors.size();
  meshes_ += list.meshes.size();
  stale_ += list.over_tau - list.placeholders.size();
  for (const DrawnImpostor& drawn : list.impostors) {
    bounds_.push_back(static_cast<float>(drawn.bound_px));
    relit_ += drawn.tile->relit;
    ages_ms_.push_back(static_cast<float>(now_us - drawn.tile->received_us) / 1000.0f);
  }
}

void SessionStats::note_use(bool first_waits, const LinkUse& use) {
  ++known_use_;
  starved_ += starves(first_waits, use);
}

void SessionStats::note_plan(const FramePlan& plan) {
  ++planned_;
  budget_ms_ = plan.budget_ms();
  scale_ += plan.setting().scale;
  samples_ += plan.setting().samples;
  lambda_ += plan.lambda();
  expected_flip_ += plan.expected_flip();
}

void SessionStats::add_light_lag(const DrawList& list, const SceneView& scene) {
  for (const DrawnImpostor& drawn : list.impostors) {
    if (!(scene.objects[drawn.tile->object].needs & kNeedLighting)) continue;
    light_lag_ms_.push_back(static_cast<float>(drawn.light_lag_us) / 1000.0f);
  }
}

void SessionStats::add_comparison(const ImageMeasures& m) {
  if (m.flip_mean) flip_.push_back(static_cast<float>(*m.flip_mean));
  if (m.flip_p99) flip_p99_.push_back(static_cast<float>(*m.flip_p99));
  if (m.psnr_db) psnr_all_.push_back(static_cast<float>(*m.psnr_db));
  if (m.ssim) ssim_all_.push_back(static_cast<float>(*m.ssim));
  if (m.coverage_iou) iou_all_.push_back(static_cast<float>(*m.coverage_iou));
}

std::string SessionStats::json(const Final& end) const {
  ordered_json j;
  const double seconds = static_cast<double>(end.duration_us) * 1e-6;
  j["frames"] = frames_;
  j["frames_drawn"] = drawn_;  // other frames kept the picture
  j["frame_ms"] = quantiles(frame_ms_, true);
  if (planned_ > 0) {
    const auto frames = static_cast<double>(planned_);
    j["budget_ms"] = budget_ms_;  // 0: none
    j["scale"] = scale_ / frames;
    j["samples"] = samples_ / frames;
    j["lambda"] = lambda_ / frames;  // FLIP px a ms
    j["expected_flip"] = expected_flip_ / frames;
  }
  const auto since_start_ms = [](std::int64_t us) {
    return us < 0 ? ordered_json(nullptr) : ordered_json(static_cast<double>(us) / 1000.0);
  };
  j["first_picture_ms"] = since_start_ms(first_picture_us_);
  j["time_to_first_image_ms"] = since_start_ms(first_image_us_);
  if (known_use_ > 0) j["starved_fraction"] = ratio(starved_, known_use_);
  j["view_tiles"] = {{"asked", end.views.asked}, {"drawn", end.views.drawn}};
  j["bytes_down"] = end.traffic.bytes_down;
  j["bytes_up"] = end.traffic.bytes_up;
  j["mbps_mean"] =
      seconds > 0
          ? 8e-6 * static_cast<double>(end.traffic.bytes_down + end.traffic.bytes_up) / seconds
          : 0.0;
  const double rest_s = static_cast<double>(end.duration_us - settled_us_) * 1e-6;
  j["mbps_after_5s"] = settled_us_ >= 0 && rest_s > 0.5
                           ? number(8e-6 *
                                    static_cast<double>(end.traffic.bytes_down +
                                                        end.traffic.bytes_up - settled_bytes_) /
                                    rest_s)
                           : ordered_json(nullptr);
  j["tiles"] = {{"asked", end.tiles.asked},
                {"received", end.tiles.received},
                {"drawn", end.tiles.drawn},
                {"wasted", end.tiles.wasted},
                {"cancelled", end.tiles.cancelled},
                {"refused", end.tiles.refused},
                {"last_asked_ms", since_start_ms(last_asked_us_)}};
  const glm::dvec3 &eye = end.home.eye, &target = end.home.target;
  j["home"] = {{"eye", {eye.x, eye.y, eye.z}}, {"target", {target.x, target.y, target.z}}};
  j["codecs"] = codecs_json(end.codecs);
  if (!light_lag_ms_.empty()) {
    j["light_lag_ms"] = {{"p50", number(quantile(light_lag_ms_, 0.50))},
                         {"p95", number(quantile(light_lag_ms_, 0.95))},
                         {"max", number(quantile(light_lag_ms_, 1.0))}};
  }
  j["relit_fraction"] = ratio(relit_, impostors_);
  j["stale_fraction"] = ratio(stale_, visible_);
  j["tile_age_ms"] = quantiles(ages_ms_, false);
  j["bound_px"] = quantiles(bounds_, true);
  j["over_tau_fraction"] = ratio(over_tau_, visible_);
  j["hole_fraction"] = geometric_.object_pixels > 0
                           ? ratio(geometric_.holes, geometric_.object_pixels)
                           : ratio(placeholders_, visible_);
  j["view_fraction"] = geometric_.object_pixels > 0
                           ? ordered_json(ratio(geometric_.viewed, geometric_.object_pixels))
                           : ordered_json(nullptr);
  j["placeholder_fraction"] = ratio(placeholders_, visible_);
  j["draw_calls"] = ratio(draw_calls_, frames_);
  j["draw_calls_max"] = most_draw_calls_;
  j["instances_drawn"] = ratio(impostors_ + meshes_ + placeholders_, frames_);
  j["impostors_drawn"] = ratio(impostors_, frames_);
  j["meshes_drawn"] = ratio(meshes_, frames_);
  j["gpu_bytes"] = gpu_.all() + gpu_target_;
  j["gpu_bytes_max"] = gpu_most_;
  j["memory"] = {{"atlas", gpu_.atlas},       {"atlas_budget", end.atlas_budget},
                 {"geometry", gpu_.geometry}, {"geometry_budget", end.geometry_budget},
                 {"shadows", gpu_.shadows},   {"view", gpu_.view},
                 {"target", gpu_target_}};
  j["uploads"] = {{"tiles", end.uploads.tiles},
                  {"bytes", end.uploads.bytes},
                  {"bytes_a_frame", ratio(end.uploads.bytes, frames_)},
                  {"largest_frame_bytes", end.uploads.largest_frame_bytes},
                  {"frame_budget", end.upload_budget},
                  {"frames_over_budget", end.uploads.frames_over_budget}};
  j["programs"] = {{"compiled", end.programs},
                   {"after_scene", end.programs_after_scene},
                   {"in_draws", end.programs_in_draws}};
  ordered_json quality;
  quality["flip"] = {{"mean", flip_.empty() ? ordered_json(nullptr) : ordered_json(mean(flip_))},
                     {"p95", flip_.empty() ? ordered_json(nullptr) : number(quantile(flip_, 0.95))},
                     {"worst", flip_.empty() ? ordered_json(nullptr) : number(quantile(flip_, 1))},
                     {"pixels_p99", number(quantile(flip_p99_, 0.5))},
                     {"pixels_p99_worst", number(quantile(flip_p99_, 1))},
                     {"each", flip_}};
  quality["psnr"] = mean_min(psnr_all_);
  quality["ssim"] = mean_min(ssim_all_);
  quality["iou"] = mean_min(iou_all_);
  if (!flicker_.empty()) {
    const auto worst = std::max_element(flicker_.begin(), flicker_.end());
    quality["flicker"] = {{"mean", mean(flicker_)},
                          {"p99", number(quantile(flicker_, 0.99))},
                          {"worst", *worst},
                          {"worst_at", worst - flicker_.begin()}};
  }
  quality["bound_violations"] = geometric_.violations;
  quality["compared_frames"] = flip_.size();
  quality["compared_pixels"] = geometric_.compared;
  quality["worst_excess_px"] = geometric_.worst_excess_px;
  quality["e1_px"] = {{"p99", number(quantile(geometric_.errors_px, 0.99))},
                      {"max", number(quantile(geometric_.errors_px, 1.0))}};
  quality["bound_over_error_median"] = number(quantile(geometric_.ratios, 0.5));
  quality["disoccluded_fraction"] = ratio(geometric_.disoccluded, geometric_.object_pixels);
  j["quality"] = quality;
  j["prediction"] = {
      {"error_m", {{"p50", end.prediction.p50_m}, {"p95", end.prediction.p95_m}}},
      {"error_deg", {{"p50", end.prediction.p50_degrees}, {"p95", end.prediction.p95_degrees}}}};
  j["scene"] = end.scene;
  j["method"] = end.method;
  j["tau_px"] = end.tau_px;
  return j.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string SessionStats::real_time_json(const Final& end, const FrameRecorder& frames) const {
  ordered_json j;
  j["frame_ms"] = quantiles(real_ms_, true);
  // Relative error of the time expected for a frame, before the prices were fitted to it.
  if (!price_errors_.empty()) {
    j["price_error"] = {{"p50", quantile(price_errors_, 0.5)},
                        {"p90", quantile(price_errors_, 0.9)}};
  }
  j["drawn"] = frames.summary();
  j["wall_s"] = end.wall_s;
  j["samples_at_end"] = end.samples;
  j["client_renderer"] = end.renderer;
  j["server_renderer"] = end.server;
  return j.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string SessionStats::table(const Final& end) const {
  const double seconds = std::max(static_cast<double>(end.duration_us) * 1e-6, 1e-9);
  std::string out = fmt::format(
      "frames           {} in {:.1f} s\n"
      "client frame     {:.1f} ms median, {:.1f} ms p99\n"
      "tiles            {} asked, {} received, {} drawn\n"
      "bytes            {:.2f} MB down, {:.3f} MB up, {:.2f} Mbit/s\n"
      "over tau         {:.1f} % of impostors in view\n",
      frames_, seconds, quantile(real_ms_, 0.5), quantile(real_ms_, 0.99), end.tiles.asked,
      end.tiles.received, end.tiles.drawn, static_cast<double>(end.traffic.bytes_down) * 1e-6,
      static_cast<double>(end.traffic.bytes_up) * 1e-6,
      8e-6 * static_cast<double>(end.traffic.bytes_down + end.traffic.bytes_up) / seconds,
      100 * ratio(over_tau_, visible_));
  if (!flip_.empty()) {
    out += fmt::format("FLIP             {:.4f} mean, {:.4f} worst over {} compared frames\n",
                       mean(flip_), quantile(flip_, 1.0), flip_.size());
    out += fmt::format("error E1         {:.2f} px p99; bound exceeded at {} of {} pixels\n",
                       quantile(geometric_.errors_px, 0.99), geometric_.violations,
                       geometric_.compared);
  }
  return out;
}

std::string trace_json(const std::vector<TileLife>& lives, const FrameRecorder& frames) {
  ordered_json tiles = ordered_json::array();
  for (const TileLife& life : lives) {
    const bool drawn = life.first_drawn_us >= 0;
    tiles.push_back(
        {{"request", life.request_id},
         {"object", life.object},
         {"instance", life.instance},
         {"edge", life.edge},
         {"bytes", life.bytes},
         {"asked_us", life.asked_us},
         {"server_queue_us", life.server_queue_us},
         {"server_render_us", life.server_render_us},
         {"server_encode_us", life.server_encode_us},
         {"received_us", life.received_us},
         {"uploaded_us", life.uploaded_us},
         {"first_drawn_us", drawn ? ordered_json(life.first_drawn_us) : ordered_json(nullptr)}});
  }
  return ordered_json{{"tiles", tiles}, {"frames", frames.json()}}.dump(1) + "\n";
}

}  // namespace mirage

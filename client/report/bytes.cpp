#include "client/report/bytes.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "client/price/cost_model.h"
#include "client/report/bytes_rows.h"
#include "client/report/session_run.h"
#include "client/report/truth_source.h"
#include "protocol/base/quantile.h"
#include "protocol/base/result.h"
#include "protocol/quality/metrics.h"

namespace mirage {
namespace {

constexpr const char* kBytesPart = "bytes";
constexpr int kAfterS = 5;  // seconds after which FLIP has a column

RunSpec spec_of(const BytesPlan& plan, const OpenScene& scene, const Delivery& delivery) {
  RunSpec spec;
  spec.url = scene.url;
  spec.path = scene.path();
  spec.method = delivery.method;
  spec.mesh_radii = delivery.mesh_radii;
  spec.samples = -1;
  spec.frame_ms = delivery.frame_ms;
  spec.device = device_model("software");
  spec.net = plan.net;
  spec.width = plan.width;
  spec.height = plan.height;
  spec.fps = plan.fps;
  const auto frame_at = [&](int s) { return static_cast<int>(std::lround(s * plan.fps)); };
  spec.frames = frame_at(plan.walks_s.back()) + 1;
  std::set<int> compared = {frame_at(kAfterS)};
  for (const int walk : plan.walks_s) {
    for (const int s : compared_seconds(walk)) compared.insert(frame_at(s));
  }
  spec.compared.assign(compared.begin(), compared.end());
  return spec;
}

double flip_at(const RunResult& result, int frame) {
  for (const ComparedFrame& compared : result.frames) {
    if (compared.frame == frame) return compared.image.flip_mean.value_or(NAN);
  }
  return NAN;
}

// Returns the figures of the beginning of a run: a walk of `walk_s` seconds.
BytesRun run_of(const BytesPlan& plan, const RunResult& result, int walk_s) {
  const auto frame_at = [&](int s) { return static_cast<int>(std::lround(s * plan.fps)); };
  BytesRun run;
  run.walk_s = walk_s;
  run.mb = 1e-6 * static_cast<double>(
                      result.planned[static_cast<std::size_t>(frame_at(walk_s))].bytes_down);
  MeasureMean flip;
  for (const int s : compared_seconds(walk_s)) flip.add(flip_at(result, frame_at(s)));
  run.flip_mean = flip.mean().value_or(NAN);
  run.flip_after_5s = flip_at(result, frame_at(kAfterS));
  if (result.first_image_ms >= 0) run.first_picture_ms = result.first_image_ms;
  std::vector<double> ms;
  for (int frame = frame_at(1); frame <= frame_at(walk_s); ++frame) {
    ms.push_back(result.planned[static_cast<std::size_t>(frame)].model_ms);
  }
  run.client_ms_p50 = quantile(ms, 0.5);
  run.client_ms_p95 = quantile(ms, 0.95);
  return run;
}

void say(const BytesRun& run) {
  std::printf("%s, %d s, %s: %.3f MB, FLIP %.4f, after 5 s %.4f, first picture %.0f ms\n",
              run.scene.c_str(), run.walk_s, run.delivery.c_str(), run.mb, run.flip_mean,
              run.flip_after_5s, run.first_picture_ms);
  std::fflush(stdout);
}

Result<void> one_scene(Context& context, const BytesPlan& plan, const std::string& name,
                       std::vector<BytesRun>& out) {
  const Result<OpenScene*> scene = context.open_own(kBytesPart, name);
  if (!scene) return scene.error();
  if (!*scene) return {};
  std::vector<std::vector<BytesRun>> by_walk(plan.walks_s.size());
  for (const Delivery& delivery : plan.deliveries) {
    const std::string what = fmt::format("{}, {}", (*scene)->name, delivery.name);
    context.progress.step(what);
    const Result<RunResult> result =
        context.runner->run(spec_of(plan, **scene, delivery), *(*scene)->truth);
    if (!result) {
      context.omit(kBytesPart, what, result.error().line());
      continue;
    }
    for (std::size_t i = 0; i < plan.walks_s.size(); ++i) {
      BytesRun run = run_of(plan, *result, plan.walks_s[i]);
      run.scene = name;
      run.delivery = delivery.name;
      say(run);
      by_walk[i].push_back(std::move(run));
    }
  }
  (*scene)->truth->forget();
  for (const auto& runs : by_walk) out.insert(out.end(), runs.begin(), runs.end());
  return {};
}

void explain(Context& context, const BytesPlan& plan) {
  Page& page = context.page;
  page.section(kBytesPart, "Bytes of a walk");
  page.command(context.options.command_line);
  page.method(fmt::format(
      "A walk of {} s from the moment of connecting; its first {} s have rows of their own. {:g} "
      "frames a second on virtual time, {}x{} pixels, a round trip of {:g} ms, {:g} Mbit/s, 5 ms "
      "of server time a tile. FLIP is the mean against the full render at 4x4 samples, every {} s "
      "of the short walk and every {} s of the long one. Client time is that of the device model "
      "'software', from the second second on.",
      plan.walks_s.back(), plan.walks_s.front(), plan.fps, plan.width, plan.height, plan.net.rtt_ms,
      plan.net.rate_mbps, compared_seconds(plan.walks_s.front()).front(),
      compared_seconds(plan.walks_s.back()).front()));
  page.method(
      "auto: as mirage-view has it, without a budget (4 samples a pixel) and with 50 ms a frame. "
      "geometry: nothing but meshes, each asked for when it comes into view, in the level that its "
      "size on the screen needs; 4 samples. tiles: auto with --mesh-radii 0, where only ground, "
      "walls and sky stay geometry, because no picture can stand for them; 4 samples. Bytes over "
      "best other: bytes of auto over those of geometry or tiles, whichever takes fewer with a "
      "FLIP at most .01 above auto's.");
}

/// FLIP against bytes: a panel for each scene, a line for each way to bring it to the client.
std::vector<Panel> panels_of(const std::vector<BytesRun>& runs) {
  std::vector<Panel> panels;
  for (const BytesRun& run : runs) {
    auto panel = std::find_if(panels.begin(), panels.end(),
                              [&](const Panel& p) { return p.title == run.scene; });
    if (panel == panels.end()) {
      panels.push_back({run.scene, "MB down", "FLIP, mean", true, false, {}, {}, {}});
      panel = panels.end() - 1;
    }
    auto series = std::find_if(panel->series.begin(), panel->series.end(),
                               [&](const Series& s) { return s.name == run.delivery; });
    if (series == panel->series.end()) {
      panel->series.push_back({run.delivery, {}});
      series = panel->series.end() - 1;
    }
    series->points.emplace_back(run.mb, run.flip_mean);
  }
  return panels;
}

void say_found(Page& page, const std::vector<BytesRun>& runs) {
  for (const auto& [mirage, better] : bytes_beside(runs)) {
    const std::string walk =
        fmt::format("{}, {} s, {}", mirage->scene, mirage->walk_s, mirage->delivery);
    if (mirage->delivery == "auto") {
      page.finding({fmt::format("{:.1f} MB", mirage->mb),
                    fmt::format("FLIP {:.3f}: {}", mirage->flip_mean, walk),
                    better && mirage->mb > better->mb});
    }
    if (better && mirage->mb > better->mb) {
      page.falls_short(
          fmt::format("{}: {:.2f} MB, {:.2f} times those of {} (FLIP {:.3f} beside "
                      "{:.3f}).",
                      walk, mirage->mb, mirage->mb / better->mb, better->delivery,
                      mirage->flip_mean, better->flip_mean));
    }
  }
}

}  // namespace

Result<void> report_bytes(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const BytesPlan plan = bytes_plan(context.options.quick);
  explain(context, plan);
  const std::vector<std::string> scenes = context.scenes_or(plan.scenes);
  context.progress.begin(kBytesPart, scenes.size() * plan.deliveries.size());
  std::vector<BytesRun> runs;
  for (const std::string& scene : scenes) {
    if (Result<void> done = one_scene(context, plan, scene, runs); !done) return done;
  }
  const std::vector<std::string> words = bytes_words(runs);
  for (const std::string& line : words) std::printf("%s\n", line.c_str());
  const Table table = bytes_table(runs);
  if (!runs.empty()) {
    say_found(context.page, runs);
    context.plot("bytes", panels_of(runs), 2,
                 "FLIP against bytes, a point for each length of the walk; lower left is better.");
    context.page.list(words);
    context.page.table(table);
  }
  return write_file(context.path("bytes.csv"), table.csv());
}

}  // namespace mirage

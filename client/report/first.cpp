#include "client/report/first.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "client/report/first_rows.h"
#include "client/report/method_runs.h"
#include "client/report/session_run.h"
#include "client/report/truth_source.h"

namespace mirage {
namespace {

constexpr const char* kFirstPart = "first";

RunSpec spec_of(const FirstPlan& plan, const OpenScene& scene, std::size_t link) {
  RunSpec spec;
  spec.url = scene.url;
  spec.path = scene.path();
  spec.net = plan.links[link];
  spec.width = plan.width;
  spec.height = plan.height;
  spec.fps = plan.fps;
  spec.frames = static_cast<int>(std::lround(plan.seconds * plan.fps)) + 1;
  for (int f = 0; f < spec.frames; f += plan.compare_every) spec.compared.push_back(f);
  if (link != plan.pictured_link) return spec;
  for (const int f : spec.compared) {
    const bool early = f < plan.pictured_from_s * plan.fps;
    const bool enough = static_cast<int>(spec.pictured.size()) == plan.pictures;
    if (!early && !enough) spec.pictured.push_back(f);
  }
  return spec;
}

void explain(Context& context, const FirstPlan& plan) {
  Page& page = context.page;
  page.section(kFirstPart, "The first seconds");
  page.command(context.options.command_line);
  page.method(fmt::format(
      "As for latency: {:g} s from the beginning of the connection at {:g} frames a second and "
      "{}x{} pixels; every {}th frame is compared with the full render at 4x4 samples. Connecting "
      "costs everyone two round trips. Until something of the scene has arrived each method shows "
      "what it has: grey, then the sky, then plain hulls for objects without an image.",
      plan.seconds, plan.fps, plan.width, plan.height, plan.compare_every));
  page.method(
      fmt::format("The first picture is the first frame with a tile, a mesh or a video frame in "
                  "it. Its FLIP is "
                  "that of the first compared frame from then on, at most {:g} ms later.",
                  1e3 * plan.compare_every / plan.fps));
}

Result<void> show_pictures(Page& page, const RunSpec& spec, const LatencyRun& run) {
  std::vector<std::pair<std::string, Picture>> strip;
  for (std::size_t i = 0; i < run.pictures.size(); ++i) {
    strip.emplace_back(fmt::format("{:.1f} s", spec.pictured[i] / spec.fps), run.pictures[i]);
  }
  return page.strip(fmt::format("{}, Mirage at RTT {:g} ms and {:g} Mbit/s; below, the full render "
                                "of the same frame.",
                                run.scene, spec.net.rtt_ms, spec.net.rate_mbps),
                    strip);
}

Result<void> run_scene(Context& context, const FirstPlan& plan, OpenScene& scene,
                       std::vector<LatencyRun>& out) {
  for (std::size_t link = 0; link < plan.links.size(); ++link) {
    const RunSpec spec = spec_of(plan, scene, link);
    for (LatencyRun& run : run_methods(context, kFirstPart, spec, plan.methods, scene)) {
      if (run.method == "mirage" && !run.pictures.empty()) {
        if (Result<void> shown = show_pictures(context.page, spec, run); !shown) return shown;
      }
      run.pictures.clear();
      out.push_back(std::move(run));
    }
  }
  scene.truth->forget();
  return {};
}

void say_first(Page& page, const std::vector<LatencyRun>& runs) {
  for (const LatencyRun& own : runs) {
    if (own.method != "mirage") continue;
    const FirstFigures f = first_figures(own);
    const NetModel& net = own.condition.net;
    const std::string where =
        fmt::format("{}, RTT {:g} ms, {:g} Mbit/s", own.scene, net.rtt_ms, net.rate_mbps);
    page.finding({fmt::format("{:.0f} ms", f.picture_ms),
                  fmt::format("first picture, FLIP {:.3f}: {}", f.flip, where)});
    for (const LatencyRun& other : runs) {
      const bool same = other.scene == own.scene && other.condition.net.rtt_ms == net.rtt_ms &&
                        other.condition.net.rate_mbps == net.rate_mbps;
      if (!same || &other == &own) continue;
      const FirstFigures g = first_figures(other);
      if (g.picture_ms < f.picture_ms && g.flip <= f.flip) {
        page.falls_short(
            fmt::format("{}: {} shows its first picture after {:.0f} ms at FLIP "
                        "{:.3f}, Mirage after {:.0f} ms at {:.3f}.",
                        where, other.method, g.picture_ms, g.flip, f.picture_ms, f.flip));
      }
    }
  }
}

}  // namespace

Result<void> report_first(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const FirstPlan plan = first_plan(context.options.quick);
  explain(context, plan);
  omit_missing_video(context, kFirstPart);
  const std::vector<std::string> scenes = context.scenes_or(plan.scenes);
  context.progress.begin(kFirstPart, scenes.size() * plan.links.size());
  std::vector<LatencyRun> runs;
  for (const std::string& name : scenes) {
    const Result<OpenScene*> scene = context.open(name);
    if (!scene) return scene.error();
    if (Result<void> done = run_scene(context, plan, **scene, runs); !done) return done;
  }
  say_first(context.page, runs);
  context.plot("first_seconds", first_panels(runs), static_cast<int>(plan.links.size()),
               "The picture's error from the beginning of the connection.");
  const Table table = first_table(runs);
  context.page.table(table);
  const Result<void> written = write_file(context.path("first_seconds.csv"), table.csv());
  if (!written) return written;
  return write_file(context.path("first_seconds_frames.csv"), first_frames(runs).csv());
}

}  // namespace mirage

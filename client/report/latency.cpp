#include "client/report/latency.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "client/report/latency_rows.h"
#ifdef MIRAGE_HAS_VIDEO
#include "client/report/video_baseline.h"
#endif

namespace mirage {
namespace {

constexpr const char* kPart = "latency";

std::string drawn_as(const std::string& method) {
  return method == "mirage" ? "auto" : method == "geometry" ? "mesh" : method;
}

bool is_video(const std::string& method) { return method.rfind("video", 0) == 0; }

RunSpec spec_of(const LatencyPlan& plan, const OpenScene& scene, const Condition& condition) {
  RunSpec spec;
  spec.url = scene.url;
  spec.path = condition.path.empty() ? scene.path() : condition.path;
  spec.net = condition.net;
  spec.width = plan.width;
  spec.height = plan.height;
  spec.fps = plan.fps;
  spec.frames = static_cast<int>(std::lround(plan.seconds * plan.fps));
  for (int f = plan.compare_every; f < spec.frames; f += plan.compare_every) {
    spec.compared.push_back(f);
  }
  return spec;
}

LatencyRun from_session(const RunResult& result, double fps) {
  LatencyRun run;
  for (const ComparedFrame& frame : result.frames) {
    run.samples.push_back({frame.frame / fps, frame.image.flip_mean.value_or(0), frame.client_ms,
                           frame.hole_fraction});
  }
  run.mbps = 8e-6 * static_cast<double>(result.traffic.bytes_down + result.traffic.bytes_up) /
             result.seconds;
  run.first_image_ms = result.first_image_ms;
  return run;
}

// All methods under one condition.
void run_condition(Context& context, const LatencyPlan& plan, OpenScene& scene,
                   const Condition& condition, std::vector<LatencyRun>& out) {
  RunSpec spec = spec_of(plan, scene, condition);
  const std::string where = fmt::format("{}, {}, RTT {:g} ms, {:g} Mbit/s", scene.name,
                                        spec.path.substr(spec.path.find(':') + 1),
                                        condition.net.rtt_ms, condition.net.rate_mbps);
  context.progress.step(where);
  const auto keep = [&](LatencyRun run, const std::string& method) {
    run.scene = scene.name;
    run.method = method;
    run.condition = condition;
    run.condition.path = spec.path;
    run.own_path = condition.path.empty();
    out.push_back(std::move(run));
  };
#ifdef MIRAGE_HAS_VIDEO
  const Result<VideoRuns> video = run_video(spec, *scene.truth);
  if (!video) context.omit(kPart, where + ", video", video.error().line());
#endif
  for (const std::string& method : plan.methods) {
    if (is_video(method)) {
#ifdef MIRAGE_HAS_VIDEO
      if (video) keep(method == "video" ? video->plain : video->warped, method);
#endif
      continue;
    }
    spec.method = drawn_as(method);
    const Result<RunResult> result = context.runner->run(spec, *scene.truth);
    if (result) {
      keep(from_session(*result, plan.fps), method);
    } else {
      context.omit(kPart, where + ", " + method, result.error().line());
    }
  }
}

// FLIP of the full render at 2x2 samples against that at 4x4, over the compared frames of the walk.
Result<double> floor_of(const RunSpec& spec, TruthSource& truth) {
  const SceneView& scene = truth.scene();
  const Result<CameraPath> path =
      CameraPath::create(spec.path, scene.home, scene.bounds_center, scene.bounds_radius);
  if (!path) return path.error();
  MeasureMean flip;
  for (const int frame : spec.compared) {
    const Camera camera =
        SessionRunner::camera_at(*path, frame / spec.fps, scene, spec.width, spec.height);
    const Result<ReferencePtr> coarse = truth.at(camera, 2), fine = truth.at(camera, 4);
    if (!coarse) return coarse.error();
    if (!fine) return fine.error();
    flip.add(measure_images({camera.width, camera.height, (*fine)->rgba.data()},
                            {camera.width, camera.height, (*coarse)->rgba.data()})
                 .flip_mean);
  }
  return flip.mean().value_or(0);
}

void explain(Context& context, const LatencyPlan& plan) {
  Page& page = context.page;
  page.section(kPart, "Against video and geometry, by latency");
  page.command(context.options.command_line);
  page.paragraph(fmt::format(
      "How it was measured: {:g} s of each path at {:g} frames a second, {}x{} pixels, all methods "
      "over the same modelled link (round trip, jitter, rate both ways, loss, in-order delivery), "
      "every {}th frame compared with the full render at the displayed pose, 4x4 samples a pixel. "
      "Everything starts at time 0 with the connection, which costs everyone two round trips; the "
      "table and the plots have what comes after the first {:g} s, a second table all frames.",
      plan.seconds, plan.fps, plan.width, plan.height, plan.compare_every, kStartSeconds));
  page.paragraph(
      "video: frames rendered by the server (2x2 samples) at the pose that was sent up, really "
      "encoded by x264 (veryfast, zerolatency, one-frame buffer, at the link's rate) and decoded; "
      "10 ms of server time are granted to render one, whatever this machine takes, and the time "
      "to encode and decode is as measured; the newest frame that has arrived is shown. "
      "video+timewarp: the same, turned to the present orientation, black where it has nothing. "
      "geometry: every object as the mesh the server sends. mirage: as shipped (auto, tau 1 px, "
      "geometry inside 8 radii); 5 ms of server time are granted per tile. pose to display: how "
      "old the eye position of what is shown is; where the client draws, what planning and drawing "
      "took on this machine.");
}

}  // namespace

Result<void> report_latency(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const LatencyPlan plan = latency_plan(context.options.quick);
  explain(context, plan);
#ifndef MIRAGE_HAS_VIDEO
  context.omit(kPart, "video, video+timewarp",
               "built without libavcodec (libavcodec-dev, "
               "libavutil-dev, libswscale-dev)");
#endif
  const std::vector<std::string> scenes = context.scenes_or(plan.scenes);
  context.progress.begin(kPart, scenes.size() * plan.conditions.size());
  std::vector<LatencyRun> runs;
  double floor = 0;
  for (const std::string& name : scenes) {
    const Result<OpenScene*> scene = context.open(name);
    if (!scene) return scene.error();
    const Result<double> measured =
        floor_of(spec_of(plan, **scene, plan.conditions.front()), *(*scene)->truth);
    if (!measured) return measured.error();
    floor = std::max(floor, *measured);
    std::string path = plan.conditions.front().path;
    for (const Condition& condition : plan.conditions) {
      if (condition.path != path) (*scene)->truth->forget();  // its poses do not come again
      path = condition.path;
      run_condition(context, plan, **scene, condition, runs);
    }
    (*scene)->truth->forget();
  }
  show_latency(context, plan, runs, floor);
  const Table settled = latency_table(runs, kStartSeconds), all = latency_table(runs, 0);
  context.page.heading(fmt::format("After the first {:g} s", kStartSeconds));
  context.page.table(settled);
  context.page.folded("The same over all frames, the start included", all);
  if (Result<void> r = write_file(context.path("latency.csv"), settled.csv()); !r) return r;
  return write_file(context.path("latency_all_frames.csv"), all.csv());
}

}  // namespace mirage

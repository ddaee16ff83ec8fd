#include "client/report/latency.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "client/report/latency_rows.h"
#include "client/report/method_runs.h"
#include "client/scene/scene_view.h"

namespace mirage {
namespace {

constexpr const char* kLatencyPart = "latency";

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

// Runs all methods under one condition.
void run_condition(Context& context, const LatencyPlan& plan, OpenScene& scene,
                   const Condition& condition, std::vector<LatencyRun>& out) {
  const RunSpec spec = spec_of(plan, scene, condition);
  for (LatencyRun& run : run_methods(context, kLatencyPart, spec, plan.methods, scene)) {
    run.own_path = condition.path.empty();
    out.push_back(std::move(run));
  }
}

// Returns the FLIP of the full render with 2x2 samples against that with 4x4, over the compared
// frames.
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
  page.section(kLatencyPart, "Against video and geometry, by latency");
  page.command(context.options.command_line);
  page.method(fmt::format(
      "All methods play {:g} s of each path at {:g} frames a second and {}x{} pixels over the same "
      "modelled link: round trip, jitter, rate both ways, loss, delivery in order. Every {}th "
      "frame "
      "is compared with the full render at the pose that is shown, 4x4 samples a pixel. Everything "
      "starts with the connection, which costs everyone two round trips. The figures count what "
      "comes after the first {:g} s; a second table counts all frames.",
      plan.seconds, plan.fps, plan.width, plan.height, plan.compare_every, kStartSeconds));
  page.method(
      "video: the server renders frames (2x2 samples) at the pose that was sent up. They are "
      "really "
      "encoded by x264 (veryfast, zerolatency, one-frame buffer, at the link's rate) and decoded. "
      "Rendering one is granted 10 ms of server time, whatever this machine takes; encoding and "
      "decoding take what was measured. The newest frame that has arrived is shown. "
      "video+timewarp: the same, turned to the present orientation, black where the video has "
      "nothing. geometry: every object as the mesh that the server sends. mirage: as shipped "
      "(auto, "
      "tau 1 px, geometry inside 8 radii), with 5 ms of server time a tile.");
  page.method(
      "Pose to display is the age of the eye position that the picture shows. Where the client "
      "draws, it is the time of planning and drawing on this machine.");
}

}  // namespace

Result<void> report_latency(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const LatencyPlan plan = latency_plan(context.options.quick);
  explain(context, plan);
  omit_missing_video(context, kLatencyPart);
  const std::vector<std::string> scenes = context.scenes_or(plan.scenes);
  context.progress.begin(kLatencyPart, scenes.size() * plan.conditions.size());
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

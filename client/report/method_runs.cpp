#include "client/report/method_runs.h"

#include <spdlog/fmt/fmt.h>

#ifdef MIRAGE_HAS_VIDEO
#include "client/report/video_baseline.h"
#endif

namespace mirage {
namespace {

std::string drawn_as(const std::string& method) {
  return method == "mirage" ? "auto" : method == "geometry" ? "mesh" : method;
}

bool is_video(const std::string& method) { return method.rfind("video", 0) == 0; }

LatencyRun from_session(RunResult result, double fps) {
  LatencyRun run;
  for (const ComparedFrame& frame : result.frames) {
    run.samples.push_back({frame.frame / fps, frame.image.flip_mean.value_or(0), frame.client_ms,
                           frame.hole_fraction});
  }
  run.mbps = 8e-6 * static_cast<double>(result.traffic.bytes_down + result.traffic.bytes_up) /
             result.seconds;
  run.first_image_ms = result.first_image_ms;
  run.pictures = std::move(result.pictures);
  return run;
}

}  // namespace

std::vector<LatencyRun> run_methods(Context& context, const std::string& part, RunSpec spec,
                                    const std::vector<std::string>& methods, OpenScene& scene) {
  const std::string where =
      fmt::format("{}, {}, RTT {:g} ms, {:g} Mbit/s", scene.name,
                  spec.path.substr(spec.path.find(':') + 1), spec.net.rtt_ms, spec.net.rate_mbps);
  context.progress.step(where);
  std::vector<LatencyRun> out;
  const auto keep = [&](LatencyRun run, const std::string& method) {
    run.scene = scene.name;
    run.method = method;
    run.condition = {spec.path, spec.net};
    out.push_back(std::move(run));
  };
#ifdef MIRAGE_HAS_VIDEO
  const Result<VideoRuns> video = run_video(spec, *scene.truth);
  if (!video) context.omit(part, where + ", video", video.error().line());
#endif
  for (const std::string& method : methods) {
    if (is_video(method)) {
#ifdef MIRAGE_HAS_VIDEO
      if (video) keep(method == "video" ? video->plain : video->warped, method);
#endif
      continue;
    }
    spec.method = drawn_as(method);
    Result<RunResult> result = context.runner->run(spec, *scene.truth);
    if (result) {
      keep(from_session(result.take(), spec.fps), method);
    } else {
      context.omit(part, where + ", " + method, result.error().line());
    }
  }
  return out;
}

void omit_missing_video([[maybe_unused]] Context& context,
                        [[maybe_unused]] const std::string& part) {
#ifndef MIRAGE_HAS_VIDEO
  context.omit(part, "video, video+timewarp",
               "built without libavcodec (libavcodec-dev, libavutil-dev, libswscale-dev)");
#endif
}

}  // namespace mirage

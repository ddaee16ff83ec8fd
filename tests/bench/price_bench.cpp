// Price benchmarks: the predictions of the cost model beside the times of frames. The model is
// fitted on some walks and tested on others.
#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "client/draw/frame_renderer.h"
#include "client/frame/camera_path.h"
#include "client/frame/planned_frame.h"
#include "client/price/cost_fit.h"
#include "client/screen/viewer_defaults.h"
#include "protocol/base/quantile.h"
#include "tests/bench/bench.h"
#include "tests/bench/bench_client.h"
#include "tests/support/process.h"

namespace mirage::bench {
namespace {

constexpr double kPriceFovY = 1.0471975511965976;  // 60 degrees
constexpr std::int64_t kPriceFrameUs = 16'667;
constexpr int kDrawnEvery = 30;          // frames; others are only planned
constexpr std::size_t kFirstFrames = 2;  // a running fit knows nothing before them

struct Walk {
  std::string scene;
  double mesh_radii = kSwapRadii;
  int width = 640, height = 360;
};

// Walks that the model is fitted to.
const Walk kFitted[] = {{"builtin:forest", 0},           {"builtin:forest", 3},
                        {"builtin:forest", 8},           {"builtin:clutter", 0},
                        {"builtin:clutter", 8},          {"builtin:city", 8},
                        {"builtin:forest", 4, 960, 540}, {"builtin:field?instances=3000", 8}};
// Walks that it is tested on.
const Walk kHeldOut[] = {
    {"builtin:forest?seed=2", 4},         {"builtin:forest?seed=2", 8, 480, 270},
    {"builtin:clutter?seed=2", 4},        {"builtin:city?seed=2", 4},
    {"builtin:field?instances=10000", 8}, {"builtin:clutter?seed=2", 8, 960, 540}};

struct Frame {
  FrameWork work;
  double ms = 0;
};

Camera camera_at(const BenchClient& client, const Pose& pose) {
  Camera camera;
  camera.pose = pose;
  camera.fov_y = kPriceFovY;
  camera.width = static_cast<std::uint32_t>(client.target().width());
  camera.height = static_cast<std::uint32_t>(client.target().height());
  camera.fit_depth_range(client.scene().bounds_center, client.scene().bounds_radius);
  return camera;
}

// Measures frames of the walk with one sample a pixel and with four: CPU time of the quicker of two
// drawings.
Result<std::vector<Frame>> measure(const Walk& walk, int frames) {
  const test::Server server(walk.scene, {"--cache-mb", "1024"});
  if (!server.ready()) return make_error(ErrorId::kInternal, "no server: " + server.log());
  HostOptions host;
  host.url = server.url();
  host.virtual_time = true;
  host.net = NetModel{};
  host.net->rtt_ms = 100;
  host.net->rate_mbps = 100;
  host.net->server_ms = 5;
  host.session.atlas_edge = kAtlasEdge;
  host.session.atlas_layers = atlas_layers(216);
  host.session.mesh_radii = walk.mesh_radii;
  Result<std::unique_ptr<BenchClient>> made =
      BenchClient::create(host, {walk.width, walk.height, 0});
  if (!made) return made.error();
  BenchClient& client = **made;
  const Result<CameraPath> path =
      CameraPath::create("builtin:walk", client.scene().home, client.scene().bounds_center,
                         client.scene().bounds_radius);
  if (!path) return path.error();
  Result<FrameTarget> four = FrameTarget::create(walk.width, walk.height, 4);
  if (!four) return four.error();
  std::vector<Frame> out;
  for (int frame = 0; frame < frames; ++frame) {
    client.host().virtual_clock()->advance_to_us(client.host().now_us() + kPriceFrameUs);
    (void)client.session().receive(client.host().now_us());
    const Camera camera = camera_at(client, path->at(frame / 60.0));
    const PlannedFrame planned = client.session().frame(camera, client.host().now_us());
    if (frame % kDrawnEvery != kDrawnEvery - 1) continue;
    for (const int samples : {1, 4}) {
      const FrameTarget& target = samples == 1 ? client.target() : *four;
      double s = HUGE_VAL;
      client.draw(target, planned);  // the first drawing takes longer
      for (int k = 0; k < 2; ++k) {
        s = std::min(s, seconds(Time::kCpu, [&] { client.draw(target, planned); }));
      }
      out.push_back({work_of(planned, camera, samples), 1e3 * s});
    }
  }
  return out;
}

// Errors of predictions, relative to the measured times.
struct Errors {
  std::vector<double> signed_by, by;
  void add(const CostModel& model, const Frame& frame) {
    signed_by.push_back(model.ms_of(frame.work) / frame.ms - 1);
    by.push_back(std::abs(signed_by.back()));
  }
  double p90() const { return quantile(by, 0.9); }
};

Row row_of(const std::string& what, const Errors& errors, const std::vector<Frame>& frames,
           double goal) {
  std::vector<double> ms;
  for (const Frame& frame : frames) ms.push_back(frame.ms);
  Row row;
  row.what = what;
  row.ours = fmt::format("p90 {:.0f} % off", 100 * errors.p90());
  row.beside = fmt::format("measured: {:.0f} ms CPU", quantile(ms, 0.5));
  row.ratio = 1 + quantile(errors.signed_by, 0.5);
  row.goal = fmt::format("p90 <= {:.0f} %", 100 * goal);
  row.met = errors.p90() <= goal;
  return row;
}

Result<std::vector<Row>> price(const Conditions& conditions) {
  constexpr double kGoal = 0.2;
  constexpr double kKnownRange = 64;  // nothing is known about this machine's prices
  const int frames = conditions.quick ? 300 : 600;
  RunningFitOptions whole;
  whole.kept = 1;
  whole.range = kKnownRange;
  CostFit fit(*device_model("software"), whole);
  for (const Walk& walk : kFitted) {
    Result<std::vector<Frame>> taken = measure(walk, frames);
    if (!taken) return taken.error();
    for (const Frame& frame : *taken) fit.add(frame.work, frame.ms);
  }
  std::string prices;
  for (std::size_t i = 0; i < kWorks; ++i) {
    prices += fmt::format("{}{} {:.3g}", i ? ", " : "", work_name(static_cast<Work>(i)),
                          fit.model().ms[i]);
  }
  std::vector<Row> rows;
  std::vector<Frame> all;
  Errors fitted, table, running;
  for (const Walk& walk : kHeldOut) {
    Result<std::vector<Frame>> taken = measure(walk, frames);
    if (!taken) return taken.error();
    CostFit follows(*device_model("software"));
    for (std::size_t s = 0; s < 2; ++s) {
      Errors here;
      std::vector<Frame> same;
      for (std::size_t k = s; k < taken->size(); k += 2) {
        const Frame& frame = (*taken)[k];
        same.push_back(frame);
        here.add(fit.model(), frame);
        fitted.add(fit.model(), frame);
        table.add(*device_model("software"), frame);
        if (k >= kFirstFrames) running.add(follows.model(), frame);
        follows.add(frame.work, frame.ms);
      }
      rows.push_back(
          row_of(fmt::format("frame's price, {} {}x{}, {:g} radii, {} samples", walk.scene,
                             walk.width, walk.height, walk.mesh_radii, s ? 4 : 1),
                 here, same, kGoal));
    }
    all.insert(all.end(), taken->begin(), taken->end());
  }
  rows.push_back(row_of("all of these frames, none of them fitted", fitted, all, kGoal));
  rows.back().note = "fitted prices, ms: " + prices;
  rows.push_back(row_of("all of these frames, prices of `software`", table, all, kGoal));
  rows.push_back(row_of("each frame after the first, by those before it", running, all, kGoal));
  return rows;
}

}  // namespace

std::vector<Bench> price_benches() {
  return {{"price", "what the cost model says of frames beside what they took", price}};
}

}  // namespace mirage::bench

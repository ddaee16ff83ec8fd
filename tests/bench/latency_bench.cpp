// Latency benchmarks: how long a tile takes beyond its drawing, with a real server, a real socket
// and a client that draws.
#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "client/draw/frame_renderer.h"
#include "client/frame/planned_frame.h"
#include "client/host/methods.h"
#include "client/native/native_link.h"
#include "client/screen/viewer_defaults.h"
#include "client/session/tile_trace.h"
#include "protocol/base/quantile.h"
#include "tests/bench/bench.h"
#include "tests/bench/bench_client.h"
#include "tests/support/process.h"

namespace mirage::bench {
namespace {

constexpr std::uint32_t kTexels = 128;
constexpr int kFrameEdge = 256;
constexpr int kReplyTimeoutMs = 5'000;

/// A client that draws whenever something has arrived, as a window does at rest.
class EagerClient {
 public:
  static Result<std::unique_ptr<EagerClient>> create(const std::string& url) {
    HostOptions options;
    options.url = url;
    options.session.trace = true;
    options.session.method = *method_from_name("quad");
    options.session.atlas_edge = kAtlasEdge;
    options.session.atlas_layers = 4;
    Result<std::unique_ptr<BenchClient>> client =
        BenchClient::create(options, {kFrameEdge, kFrameEdge, 0});
    if (!client) return client.error();
    auto out = std::make_unique<EagerClient>();
    out->client_ = client.take();
    return out;
  }

  /// Looks at the scene's middle from `turn` (radians) around it until no better tile is expected.
  Result<void> look_from(double turn) {
    const SceneView& scene = session().scene();
    Camera camera;
    camera.width = camera.height = kFrameEdge;
    camera.fov_y = 0.9;
    // The distance at which a tile of kTexels fits, at 1.5 texels a pixel.
    const double distance = 4.4 * scene.bounds_radius * kFrameEdge * 1.5 / (2.0 * kTexels);
    const glm::dvec3 eye =
        scene.bounds_center + distance * glm::dvec3(std::cos(turn), 0.2, std::sin(turn));
    camera.pose = look_at(eye, scene.bounds_center);
    camera.fit_depth_range(scene.bounds_center, scene.bounds_radius);
    ClientHost& host = client_->host();
    for (int frame = 0; frame < 200; ++frame) {
      if (Result<void> came = session().receive(host.now_us()); !came) return came;
      client_->draw(client_->target(), session().frame(camera, host.now_us()));
      session().note_drawn(host.now_us());
      if (session().in_flight() == 0 && frame > 1) return {};
      if (session().in_flight() > 0) host.wait_message(kReplyTimeoutMs);
    }
    return make_error(ErrorId::kInternal, "the client keeps asking");
  }
  ClientSession& session() { return client_->session(); }

 private:
  std::unique_ptr<BenchClient> client_;
};

Result<std::vector<Row>> latency(const Conditions& conditions) {
  constexpr double kGoalMs = 2;
  const test::Server server("builtin:knot", {"--no-geometry", "--no-reference"});
  if (!server.ready()) return make_error(ErrorId::kInternal, "no server: " + server.log());
  Result<std::unique_ptr<EagerClient>> client = EagerClient::create(server.url());
  if (!client) return client.error();
  for (int i = 0; i < (conditions.quick ? 60 : 300); ++i) {
    if (Result<void> looked = (*client)->look_from(0.7 * i); !looked) return looked.error();
  }
  std::vector<double> beyond, render, queue, encode, way, upload, draw;
  for (const TileLife& life : (*client)->session().lives()) {
    if (life.edge != kTexels || life.first_drawn_us < 0) continue;
    const auto ms = [](std::int64_t us) { return 1e-3 * static_cast<double>(us); };
    const std::int64_t server_us =
        std::int64_t{life.server_queue_us} + life.server_render_us + life.server_encode_us;
    beyond.push_back(ms(life.first_drawn_us - life.asked_us - life.server_render_us));
    render.push_back(ms(life.server_render_us));
    queue.push_back(ms(life.server_queue_us));
    encode.push_back(ms(life.server_encode_us));
    way.push_back(ms(life.received_us - life.asked_us - server_us));
    upload.push_back(ms(life.uploaded_us - life.received_us));
    draw.push_back(ms(life.first_drawn_us - life.uploaded_us));
  }
  if (beyond.size() < 20) {
    return make_error(ErrorId::kInternal,
                      fmt::format("only {} tiles of {} texels among {}", beyond.size(), kTexels,
                                  (*client)->session().lives().size()));
  }
  const auto both = [](const std::vector<double>& v) {
    return fmt::format("{:.2f} / {:.2f}", quantile(v, 0.5), quantile(v, 0.95));
  };
  const double p50 = quantile(beyond, 0.5);
  return std::vector<Row>{
      {"request to first draw without rendering, 128 texels, p50 / p95", both(beyond) + " ms",
       fmt::format("goal: {:g} ms", kGoalMs), p50 / kGoalMs, "<= 1", p50 <= kGoalMs, std::nullopt,
       fmt::format("{} tiles; ms p50 / p95: queue {}, [rendering {}], encode {}, sockets and wakes "
                   "{}, decode and upload {}, the client's frame {}",
                   beyond.size(), both(queue), both(render), both(encode), both(way), both(upload),
                   both(draw))}};
}

}  // namespace

std::vector<Bench> latency_benches() {
  return {{"latency", "a tile from request to first draw", latency}};
}

}  // namespace mirage::bench

// Client benchmarks: the cost of a client's frame, beside the same frame drawn from all geometry,
// and by the number of instances.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "client/draw/frame_renderer.h"
#include "client/frame/camera_path.h"
#include "client/frame/planned_frame.h"
#include "client/host/methods.h"
#include "client/link/link.h"
#include "client/link/modelled_link.h"
#include "client/price/cost_model.h"
#include "client/screen/viewer_defaults.h"
#include "protocol/base/quantile.h"
#include "protocol/quality/metrics.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/sky_pass.h"
#include "shaders/gl/view_depth.h"
#include "tests/bench/bench.h"
#include "tests/bench/bench_client.h"
#include "tests/support/large_scene.h"
#include "tests/support/process.h"

namespace mirage::bench {
namespace {

constexpr int kWidth = 1280, kHeight = 720;
constexpr int kMsaa = 4;
constexpr double kFovY = 1.0471975511965976;  // 60 degrees
constexpr int kSettleFrames = 400;
constexpr int kAtlasMb = 216;
constexpr std::int64_t kFrameUs = 16'667;

// Draws every instance in view from its whole mesh, near ones first, into the same target: what a
// client without impostors and levels of detail draws.
class FullGeometry {
 public:
  explicit FullGeometry(std::shared_ptr<const PreparedScene> scene) : scene_(std::move(scene)) {}

  Result<void> prepare() {
    Result<gl::SkyPass> sky = gl::SkyPass::create();
    if (!sky) return sky.error();
    sky_ = std::move(*sky);
    pass_.set_surroundings(scene_.prepared->scene.environment);
    if (Result<void> ready = sky_.prepare(scene_.prepared->scene.environment); !ready) return ready;
    for (const gl::GpuMesh& mesh : scene_.meshes) {
      Result<void> compiled = pass_.warm_up(mesh, scene_.materials(), true);
      if (!compiled) return compiled;
    }
    return {};
  }
  std::uint64_t triangles() const { return triangles_; }

  void draw(const FrameTarget& target, const Camera& camera) {
    const PreparedScene& prepared = *scene_.prepared;
    const glm::dvec3 eye = camera.pose.eye;
    const Frustum frustum(camera);
    std::vector<std::vector<std::pair<double, std::uint32_t>>> visible(scene_.meshes.size());
    triangles_ = 0;
    for (std::uint32_t i = 0; i < prepared.scene.instances.size(); ++i) {
      const Instance& instance = prepared.scene.instances[i];
      const ObjectDescription& object = prepared.objects[instance.object];
      const Similarity& m = instance.world_from_object;
      const glm::dvec3 center =
          m.position - eye + glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale});
      const double radius = double{object.radius} * m.scale;
      if (!frustum.may_see(center, radius)) continue;
      visible[instance.object].emplace_back(glm::length(center) - radius, i);
      triangles_ += object.triangles;
    }
    target.bind();
    glEnable(GL_FRAMEBUFFER_SRGB);
    glDepthMask(GL_TRUE);
    const gl::ViewDepth view_depth;
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    pass_.begin(camera.clip_from_relative(view_depth.mapping()),
                gl::light_block(prepared.scene.lighting, eye), view_depth.mapping());
    pass_.set_fog(prepared.scene.environment.horizon, prepared.scene.environment.fog_density);
    for (std::size_t object = 0; object < visible.size(); ++object) {
      std::sort(visible[object].begin(), visible[object].end());
      std::vector<gl::MeshInstance> instances;
      for (const auto& [distance, i] : visible[object]) {
        instances.push_back(
            gl::mesh_instance(prepared.scene.instances[i].world_from_object, eye, i));
      }
      if (instances.empty()) continue;
      pass_.draw(scene_.meshes[object], scene_.materials(), scene_.images, instances.data(),
                 instances.size(), false);
    }
    pass_.end();
    sky_.draw_behind(camera, prepared.scene.environment, view_depth);
  }

 private:
  GpuScene scene_;
  gl::MeshPass pass_{gl::MeshOutput::kColor};
  gl::SkyPass sky_;
  std::uint64_t triangles_ = 0;
};

/// A client on virtual time and a modelled link, frame by frame.
class Client {
 public:
  struct Options {
    NetModel net;
    double mesh_radii = kSwapRadii;
    int width = kWidth, height = kHeight;
    int samples = kMsaa;
    double frame_ms = 0;  ///< budget, by prices of `software`; 0: any time
  };
  static Result<std::unique_ptr<Client>> create(const std::string& url, const Options& options) {
    HostOptions host;
    host.url = url;
    host.virtual_time = true;
    host.net = options.net;
    host.session.atlas_edge = kAtlasEdge;
    host.session.atlas_layers = atlas_layers(kAtlasMb);
    host.session.animation = false;
    host.session.mesh_radii = options.mesh_radii;
    host.session.frame_ms = options.frame_ms;
    host.session.samples = std::max(options.samples, 1);
    Result<std::unique_ptr<BenchClient>> client =
        BenchClient::create(host, {options.width, options.height, options.samples});
    if (!client) return client.error();
    auto out = std::make_unique<Client>();
    out->client_ = client.take();
    if (options.frame_ms > 0) out->host().session().set_prices(*device_model("software"));
    return out;
  }

  const SceneView& scene() const { return client_->scene(); }
  Camera camera(const Pose& pose) const {
    Camera camera;
    camera.pose = pose;
    camera.fov_y = kFovY;
    camera.width = static_cast<std::uint32_t>(target().width());
    camera.height = static_cast<std::uint32_t>(target().height());
    camera.fit_depth_range(scene().bounds_center, scene().bounds_radius);
    return camera;
  }
  /// Plans a frame of 1/60 s without drawing it.
  void plan(const Camera& camera) {
    host().virtual_clock()->advance_to_us(host().now_us() + kFrameUs);
    (void)host().session().receive(host().now_us());
    planned_ = host().session().frame(camera, host().now_us());
  }
  void plan_and_draw(const Camera& camera) {
    plan(camera);
    draw(target());
  }
  /// Draws what was planned last.
  void draw(const FrameTarget& target) { client_->draw(target, planned_); }
  /// Plans frames until nothing more is expected to arrive.
  void settle(const Camera& camera) {
    for (int frame = 0; frame < kSettleFrames; ++frame) {
      plan(camera);
      if (frame > 20 && host().session().at_rest()) return;
    }
  }
  /// Returns the FLIP of what was last drawn into target().
  double flip(const ReferenceFrame& truth) const {
    const std::vector<std::uint8_t> drawn = target().read();
    return measure_images({truth.width, truth.height, truth.rgba.data()},
                          {truth.width, truth.height, drawn.data()})
        .flip_mean.value_or(NAN);
  }
  const FrameTarget& target() const { return client_->target(); }
  ClientHost& host() { return client_->host(); }
  const DrawList& list() const { return planned_.list; }

 private:
  std::unique_ptr<BenchClient> client_;
  PlannedFrame planned_;
};

NetModel fast_link() {
  NetModel net;
  net.rtt_ms = 20;
  net.rate_mbps = 1000;
  net.server_ms = 0.01;
  return net;
}

struct Compared {
  std::string scene, what;
  double goal = 1;
  int rounds = 1;
  double mesh_radii = kSwapRadii;
  int samples = kMsaa;
  double frame_ms = 0;  ///< budget; 0: any time
};

Result<Row> compare(const Compared& compared) {
  const test::Server server(compared.scene, {"--cache-mb", "1024"});
  if (!server.ready()) return make_error(ErrorId::kInternal, "no server: " + server.log());
  Client::Options options;
  options.net = fast_link();
  options.mesh_radii = compared.mesh_radii;
  options.samples = compared.samples;
  options.frame_ms = compared.frame_ms;
  Result<std::unique_ptr<Client>> made = Client::create(server.url(), options);
  if (!made) return made.error();
  Client& client = **made;
  Result<std::shared_ptr<const PreparedScene>> prepared = load_scene(compared.scene);
  if (!prepared) return prepared.error();
  FullGeometry full(prepared.take());
  if (Result<void> ready = full.prepare(); !ready) return ready.error();
  const HomeView& home = client.scene().home;
  const Camera camera = client.camera(look_at(home.eye, home.target));
  client.settle(camera);
  const auto draw_full = [&] {
    full.draw(client.target(), camera);
    glFinish();
  };
  const Pair pair = in_turn(
      Time::kCpu, compared.rounds, [&] { client.plan_and_draw(camera); }, draw_full);
  const double full_s = pair.beside_s;
  Result<ReferenceFrame> truth = client.host().reference(camera, 2);
  if (!truth) return truth.error();
  const double full_flip = client.flip(*truth);  // it was drawn last
  client.plan_and_draw(camera);
  Row row;
  row.what = compared.what;
  row.ours = fmt::format("{:.0f} ms CPU, FLIP {:.3f}", 1e3 * pair.ours_s, client.flip(*truth));
  row.beside = fmt::format("all geometry: {:.0f} ms, FLIP {:.3f}", 1e3 * full_s, full_flip);
  row.ratio = pair.ratio;
  row.goal = fmt::format(">= {:g} times", compared.goal);
  row.met = pair.ratio >= compared.goal;
  row.spread_pct = pair.spread_pct;
  row.note =
      fmt::format("{}x{}, {} samples; {} impostors, {} meshes; {:.1f} M triangles in view", kWidth,
                  kHeight, std::max(compared.samples, 1), client.list().impostors.size(),
                  client.list().meshes.size(), 1e-6 * static_cast<double>(full.triangles()));
  return row;
}

Result<std::vector<Row>> against_geometry(const Conditions& conditions) {
  const std::string balls = test::scratch_folder() + "/balls.glb";
  test::LargeScene many;
  many.triangles = 140'000;
  many.meshes = 1;
  many.copies = conditions.quick ? 400 : 1600;
  if (Result<std::uint64_t> written = test::write_large_glb(balls, many); !written) {
    return written.error();
  }
  const int rounds = conditions.quick ? 1 : 7;
  std::vector<Compared> all = {
      {"builtin:forest", "client frame, forest of 400 trees", 80, rounds},
      {"builtin:forest", "client frame, forest of 400 trees, one sample", 80, rounds, kSwapRadii,
       0},
      {balls, fmt::format("client frame, {} balls of 140,000 triangles", many.copies), 100, 1}};
  if (!conditions.quick) {
    all.push_back({"builtin:forest", "forest of 400 trees, no geometry of trees", 80, rounds, 0});
    // FLIP may be worse by .03 (row.ours and row.beside tell by how much it is).
    all.push_back({"builtin:forest", "forest of 400 trees, within a budget of 100 ms", 40, rounds,
                   kAnyRadii, kMsaa, 100});
  }
  std::vector<Row> rows;
  for (const Compared& one : all) {
    Result<Row> row = compare(one);
    if (!row) return row.error();
    rows.push_back(row.take());
  }
  return rows;
}

// A walk through a field, as a user with 20 Mbit/s and 100 ms sees it, with as many samples a pixel
// as the viewer chooses here.
Result<std::vector<Row>> field(const Conditions& conditions) {
  constexpr double kGoalMs = 60, kFirstGoalMs = 1000;
  constexpr double kBudgetMs = 50;  // a viewer's budget on a software renderer
  constexpr int kDrawnEvery = 8;    // frames; others are only planned
  std::vector<Row> rows;
  double before_ms = 0;
  for (const int instances : {10'000, 100'000, 1'000'000}) {
    const test::Server server(fmt::format("builtin:field?instances={}", instances), {});
    if (!server.ready()) return make_error(ErrorId::kInternal, "no server: " + server.log());
    Client::Options options;
    options.net.rtt_ms = 100;
    options.net.rate_mbps = 20;
    options.net.server_ms = 5;
    options.width = 640;
    options.height = 360;
    Result<std::unique_ptr<Client>> made = Client::create(server.url(), options);
    if (!made) return made.error();
    Client& client = **made;
    const HomeView& home = client.scene().home;
    double first_ms = -1;
    Result<FrameTarget> plain = FrameTarget::create(options.width, options.height, 0);
    if (!plain) return plain.error();
    std::vector<double> four_ms, one_ms, four_wall_ms;
    const int frames = conditions.quick ? 240 : 600;
    for (int frame = 0; frame < frames; ++frame) {
      const glm::dvec3 way = 1.4 * frame / 60.0 * glm::normalize(home.target - home.eye);
      const Camera camera = client.camera(look_at(home.eye + way, home.target + way));
      const bool drawn = frame >= frames / 2 && frame % kDrawnEvery == 0;
      const double plan_s = seconds(Time::kCpu, [&] { client.plan(camera); });
      if (drawn) {
        double wall_s = 0;
        const double four_s = seconds(Time::kCpu, [&] {
          wall_s = seconds(Time::kWall, [&] { client.draw(client.target()); });
        });
        four_wall_ms.push_back(1e3 * wall_s);
        four_ms.push_back(1e3 * (plan_s + four_s));
        const double one_s = seconds(Time::kCpu, [&] { client.draw(*plain); });
        one_ms.push_back(1e3 * (plan_s + one_s));
      }
      const bool shows = !client.list().impostors.empty();
      if (first_ms < 0 && shows) first_ms = 1e-3 * static_cast<double>(client.host().now_us());
    }
    const bool four = middle(four_wall_ms).median <= kBudgetMs;
    const Middle frame_ms = middle(four ? four_ms : one_ms);
    Row row;
    row.what = fmt::format("client frame, walking into a field of {} instances", instances);
    row.ours = fmt::format("{:.0f} ms CPU, first image {:.0f} ms", frame_ms.median, first_ms);
    row.beside = before_ms > 0 ? fmt::format("a tenth of them: {:.0f} ms", before_ms)
                               : fmt::format("goal: {:g} ms", kGoalMs);
    row.ratio = frame_ms.median / (before_ms > 0 ? before_ms : kGoalMs);
    row.goal = "<= 60 ms, 1 s";
    row.met = frame_ms.median <= kGoalMs && first_ms >= 0 && first_ms <= kFirstGoalMs;
    row.spread_pct = frame_ms.spread_pct;
    row.note = fmt::format(
        "640x360, {} a pixel, as the viewer chooses here, with four {:.0f} ms; {:.1f} MB down, {} "
        "of them known; {} impostors",
        four ? "four samples" : "one sample", middle(four_ms).median,
        1e-6 * static_cast<double>(client.host().traffic().bytes_down),
        client.scene().instances.size(), client.list().impostors.size());
    rows.push_back(row);
    before_ms = frame_ms.median;
  }
  return rows;
}

// The longest frames of a walk, with a link that has room, and with one that never has.
Result<std::vector<Row>> saturation(const Conditions& conditions) {
  constexpr double kGoal = 1.2;
  const test::Server server("builtin:forest?trees=120", {});
  if (!server.ready()) return make_error(ErrorId::kInternal, "no server: " + server.log());
  const int frames = conditions.quick ? 300 : 900;
  struct Walk {
    double p50 = 0, p99 = 0, mbps = 0;
  };
  const auto walk = [&](double rate_mbps) -> Result<Walk> {
    Client::Options options;
    options.net.rtt_ms = 100;
    options.net.rate_mbps = rate_mbps;
    options.net.server_ms = 5;
    options.width = 320;
    options.height = 180;
    options.mesh_radii = 0;  // otherwise missing geometry makes the full link's frames quicker
    Result<std::unique_ptr<Client>> made = Client::create(server.url(), options);
    if (!made) return made.error();
    Client& client = **made;
    const Result<CameraPath> path =
        CameraPath::create("builtin:walk", client.scene().home, client.scene().bounds_center,
                           client.scene().bounds_radius);
    if (!path) return path.error();
    std::vector<double> ms;
    for (int frame = 0; frame < frames; ++frame) {
      const Camera camera = client.camera(path->at(frame / 60.0));
      const double frame_s = seconds(Time::kCpu, [&] { client.plan_and_draw(camera); });
      if (frame >= frames / 3) ms.push_back(1e3 * frame_s);
    }
    const double seconds = 1e-6 * static_cast<double>(client.host().now_us());
    return Walk{quantile(ms, 0.5), quantile(ms, 0.99),
                8e-6 * static_cast<double>(client.host().traffic().bytes_down) / seconds};
  };
  const Result<Walk> roomy = walk(100);
  if (!roomy) return roomy.error();
  const Result<Walk> full = walk(1);
  if (!full) return full.error();
  Row row;
  row.what = "client frame p99, walk with the link saturated";
  row.ours = fmt::format("{:.0f} ms CPU", full->p99);
  row.beside = fmt::format("with room: {:.0f} ms", roomy->p99);
  row.ratio = full->p99 / roomy->p99;
  row.goal = "<= 1.2 times";
  row.met = row.ratio <= kGoal;
  row.note = fmt::format("p50 {:.0f} and {:.0f} ms; {:.2f} of 1 Mbit/s used, {:.2f} of 100",
                         full->p50, roomy->p50, full->mbps, roomy->mbps);
  return std::vector<Row>{row};
}

}  // namespace

std::vector<Bench> client_benches() {
  return {{"client", "a client's frame beside all geometry", against_geometry},
          {"field", "a client's frame and first image by the number of instances", field},
          {"saturation", "a client's longest frames when the link is full", saturation}};
}

}  // namespace mirage::bench

#include "client/report/session_run.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "client/door/client.h"
#include "client/draw/frame_renderer.h"
#include "client/frame/planned_frame.h"
#include "client/host/client_host.h"
#include "client/host/methods.h"
#include "client/link/modelled_link.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/screen/viewer_defaults.h"
#include "client/session/client_session.h"
#include "protocol/impostor/tile_key.h"
#include "shaders/gl/egl_context.h"

namespace mirage {
namespace {

constexpr int kAtlasMb = 216;
constexpr double kFovY = 1.0471975511965976;  // 60 degrees

double clock_ms(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

Camera screen_of(const RunSpec& spec) {
  Camera screen;
  screen.fov_y = kFovY;
  screen.width = static_cast<std::uint32_t>(spec.width);
  screen.height = static_cast<std::uint32_t>(spec.height);
  return screen;
}

HostOptions host_options(const RunSpec& spec) {
  HostOptions options;
  options.url = spec.url;
  options.virtual_time = true;
  options.net = spec.net;
  options.session.tau_px = spec.tau_px;
  options.session.method = *method_from_name(spec.method);
  options.session.mesh_radii = spec.mesh_radii;
  options.session.frame_ms = spec.frame_ms;
  options.session.samples = spec.samples;
  options.session.screen = screen_of(spec);
  options.session.trace = true;
  options.session.animation = false;
  return options;
}

}  // namespace

struct SessionRunner::Loop {
  const RunSpec& spec;
  TruthSource& truth;
  ClientHost& host;
  RunResult& out;
  const CameraPath& path;
  std::int64_t start_us = 0;
  int rested = 0;         // frames in which a viewer would have refined the picture
  double planned_ms = 0;  // of this frame
  int before = -2;        // last compared frame
  std::vector<std::uint8_t> drawn_before{};
  ReferencePtr truth_before{};
};

struct SessionRunner::Graphics {
  gl::EglContext egl;
  std::string renderer_name;
  Client client;
};

SessionRunner::SessionRunner() : graphics_(std::make_unique<Graphics>()) {}
SessionRunner::~SessionRunner() = default;

FrameRenderer& SessionRunner::renderer() { return graphics_->client.renderer(); }
const std::string& SessionRunner::renderer_name() const { return graphics_->renderer_name; }
bool SessionRunner::software() const { return graphics_->egl.software(); }

Result<std::unique_ptr<SessionRunner>> SessionRunner::create(const std::string& device) {
  auto runner = std::make_unique<SessionRunner>();
  Result<gl::EglContext> egl = gl::EglContext::create(device);
  if (!egl) return egl.error();
  runner->graphics_->egl = std::move(*egl);
  runner->graphics_->renderer_name = runner->graphics_->egl.description();
  ClientGraphics graphics;
  graphics.atlas_edge = kAtlasEdge;
  graphics.atlas_layers = atlas_layers(kAtlasMb);
  graphics.flat = kFlatMethods;
  if (Result<void> made = runner->graphics_->client.attach(graphics); !made) return made.error();
  return runner;
}

double SessionRunner::now_ms() const {
  return clock_ms(software() ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC);
}

Camera SessionRunner::camera_at(const CameraPath& path, double seconds, const SceneView& scene,
                                int width, int height) {
  Camera camera;
  camera.pose = path.at(1e-6 * static_cast<double>(std::llround(seconds * 1e6)));
  camera.fov_y = kFovY;
  camera.width = static_cast<std::uint32_t>(width);
  camera.height = static_cast<std::uint32_t>(height);
  camera.fit_depth_range(scene.bounds_center, scene.bounds_radius);
  return camera;
}

double SessionRunner::add_geometric(Loop& loop, const PlannedFrame& planned,
                                    const ReferenceFrame& truth) {
  const SceneView& scene = *planned.scene;
  const double s = loop.spec.truth_samples;
  const std::uint64_t pixels_before = loop.out.geometric.object_pixels;
  const std::uint64_t holes_before = loop.out.geometric.holes;
  if (scene.complete()) {
    add_geometric_error(truth, (std::floor(s / 2) + 0.5) / s, planned, loop.out.geometric);
  } else if (!planned.list.view) {  // nothing is known yet: everything is missing
    const auto& ids = truth.ids;
    const auto missing =
        ids.size() - static_cast<std::size_t>(std::count(ids.begin(), ids.end(), 0u));
    loop.out.geometric.object_pixels += missing;
    loop.out.geometric.holes += missing;
  }
  const std::uint64_t pixels = loop.out.geometric.object_pixels - pixels_before;
  const std::uint64_t holes = loop.out.geometric.holes - holes_before;
  return pixels > 0 ? static_cast<double>(holes) / static_cast<double>(pixels) : 0;
}

Result<void> SessionRunner::compare(Loop& loop, int frame) {
  const RunSpec& spec = loop.spec;
  const ClientSession& session = loop.host.session();
  Client& client = graphics_->client;
  Screen& screen = client.screen();
  const PlannedFrame& planned = client.planned();
  const Camera& camera = planned.camera;
  ComparedFrame compared;
  compared.frame = frame;
  const auto draw = [&] {
    const double began = now_ms();
    screen.draw(client.renderer(), planned);
    glFinish();
    return loop.planned_ms + now_ms() - began;
  };
  // The first use compiles, so it is left out of the times (numerics.md section 1).
  if (loop.out.frames.empty() && spec.draws_each > 1) draw();
  compared.client_ms = INFINITY;
  for (int i = 0; i < spec.draws_each; ++i) {
    const double ms = draw();
    compared.client_ms = std::min(compared.client_ms, ms);
    loop.out.client_ms.push_back(ms);
  }
  for (int i = 0; i < loop.rested && !screen.refined(); ++i) {
    screen.refine(client.renderer(), planned);
  }
  std::vector<std::uint8_t> drawn = screen.shown().read();
  Result<ReferencePtr> truth = loop.truth.at(camera, spec.truth_samples);
  if (!truth) return truth.error();
  const std::uint32_t w = camera.width, h = camera.height;
  const ImageView seen{w, h, drawn.data()}, due{w, h, (*truth)->rgba.data()};
  compared.image = measure_images(due, seen);
  if (loop.before + 1 == frame) {
    compared.flicker = flicker({w, h, loop.truth_before->rgba.data()},
                               {w, h, loop.drawn_before.data()}, due, seen);
  }
  if (spec.observe && session.scene().complete()) {
    spec.observe({session.scene(), planned.list, session.considered(), session.plan(), **truth, seen, due});
  }
  compared.hole_fraction = add_geometric(loop, planned, **truth);
  if (std::binary_search(spec.pictured.begin(), spec.pictured.end(), frame)) {
    loop.out.pictures.push_back({spec.width, spec.height, drawn, (*truth)->rgba});
  }
  loop.before = frame;
  loop.drawn_before = std::move(drawn);
  loop.truth_before = *truth;
  loop.out.frames.push_back(compared);
  return {};
}

// Runs a viewer's frame, but draws it only if it is compared.
Result<void> SessionRunner::one_frame(Loop& loop, int frame) {
  const RunSpec& spec = loop.spec;
  Client& client = graphics_->client;
  ClientSession& session = client.session();
  const double seconds = frame / spec.fps;
  const std::int64_t now = loop.start_us + std::llround(seconds * 1e6);
  loop.host.virtual_clock()->advance_to_us(now);
  if (Result<void> received = client.update(now); !received) return received;
  if (Result<void> sized = client.resize(spec.width, spec.height); !sized) return sized;
  const double began = now_ms();
  const Result<FrameStep> step =
      client.plan(camera_at(loop.path, seconds, session.scene(), spec.width, spec.height), now);
  if (!step) return step.error();
  loop.planned_ms = now_ms() - began;
  const bool same = *step != FrameStep::kDraw;
  loop.rested = same && session.at_rest() ? loop.rested + 1 : 0;
  const PlannedFrame& planned = client.planned();
  PricedFrame priced{planned.setting, 0, loop.host.traffic().bytes_down};
  if (spec.device && !same) {
    priced.model_ms = spec.device->ms_of(client.screen().work(planned));
    session.note_frame_ms(priced.model_ms);
  }
  RunResult& out = loop.out;
  out.planned.push_back(priced);
  const DrawList& list = planned.list;
  out.visible += list.visible;
  out.placeholders += list.placeholders.size();
  const std::optional<LinkUse> use = loop.host.link_use();
  out.starved += use && starves(session.first_waits(), *use);
  const bool shows = list.view || !list.impostors.empty() || !list.meshes.empty();
  if (shows && out.first_image_ms < 0) out.first_image_ms = seconds * 1e3;
  const bool compared = std::binary_search(spec.compared.begin(), spec.compared.end(), frame);
  return compared ? compare(loop, frame) : Result<void>{};
}

Result<RunResult> SessionRunner::run(const RunSpec& spec, TruthSource& truth) {
  const SceneView& scene = truth.scene();
  const Result<CameraPath> path =
      CameraPath::create(spec.path, scene.home, scene.bounds_center, scene.bounds_radius);
  if (!path) return path.error();
  HostOptions options = host_options(spec);
  ClientHost host(std::move(options), graphics_->client);
  if (Result<void> open = host.open(); !open) return open.error();
  if (spec.device) host.session().set_prices(*spec.device);
  if (spec.from_scene) {
    if (Result<void> told = host.wait_for_picture(); !told) return told.error();
  }
  RunResult out;
  Loop loop{spec, truth, host, out, *path, host.now_us()};
  for (int frame = 0; frame < spec.frames; ++frame) {
    if (Result<void> done = one_frame(loop, frame); !done) return done.error();
  }
  out.traffic = host.traffic();
  out.seconds = spec.frames / spec.fps;
  out.lives = host.session().lives();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "GL error " + std::to_string(error));
  }
  return out;
}

}  // namespace mirage

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
#include "client/report/frame_comparison.h"
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
  ClientHost& host;
  RunResult& out;
  const CameraPath& path;
  FrameComparison comparison;
  std::int64_t start_us = 0;
  int rested = 0;  // frames in which a viewer would have refined the picture
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
  const double planned_ms = now_ms() - began;
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
  if (!compared) return {};
  return loop.comparison.compare(client, {frame, planned_ms, loop.rested});
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
  const auto clock = [this] { return now_ms(); };
  Loop loop{spec, host, out, *path, {spec, truth, clock, out}, host.now_us()};
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

#include "client/view/viewer.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "client/core/camera_path.h"
#include "client/core/client_session.h"
#include "client/core/frame_renderer.h"
#include "client/core/quantile.h"
#include "client/native/native_link.h"
#include "client/view/comparison.h"
#include "client/view/light_script.h"
#include "client/view/overlay.h"
#include "client/view/png.h"
#include "client/view/session_stats.h"
#include "client/view/window.h"
#include "shaders/gl/egl_context.h"

namespace mirage {
namespace {

constexpr int kReferenceTimeoutMs = 120'000;
constexpr int kReplyTimeoutMs = 30'000;

class Viewer {
 public:
  explicit Viewer(const ViewOptions& options) : o_(options) {}
  Result<void> run();

 private:
  Result<void> open_graphics();
  Result<void> open_link();
  void open_session();
  Result<void> wait_for_scene();
  Result<void> frame_loop();
  Result<void> one_frame(std::int64_t frame);
  Result<void> compare(const Camera& camera, const DrawList& list);
  Result<void> finish();
  Result<void> fit_target();
  Pose next_pose(std::int64_t now_us, double real_seconds);
  void pace(std::int64_t frame);
  std::string overlay_text(const DrawList& list, std::int64_t now) const;
  std::int64_t now_us() const { return clock_->now_us() - paused_us_; }
  std::int64_t frame_us(std::int64_t frame) const {
    return std::llround(static_cast<double>(frame) * 1e6 / o_.fps);
  }

  const ViewOptions& o_;
  std::unique_ptr<Clock> clock_;
  VirtualClock* virtual_clock_ = nullptr;
  SteadyClock real_clock_;
  std::int64_t paused_us_ = 0;  // time spent comparing, which is no part of the session
  std::int64_t start_us_ = 0;
  std::optional<Window> window_;
  gl::EglContext egl_;
  std::optional<FrameTarget> target_;
  bool blends_ = false;  ///< something of the scene is blended
  std::optional<FrameRenderer> renderer_;
  std::unique_ptr<NativeLink> native_;
  std::unique_ptr<ModelledLink> modelled_;
  std::unique_ptr<ClientSession> session_;
  std::optional<CameraPath> path_;
  std::optional<LightScript> light_;
  Pose pose_;
  SessionStats stats_;
  std::optional<Lighting> last_light_;
  bool link_was_up_ = true;
  std::optional<Overlay> overlay_;
  double smooth_ms_ = 0;
  Comparison comparison_;
};

constexpr int kAtlasEdge = 1024;

int atlas_layers(const ViewOptions& o) {
  return std::max(1, o.atlas_mb * 1024 * 1024 / (kAtlasEdge * kAtlasEdge * 5));
}

Result<void> Viewer::open_graphics() {
  if (o_.offscreen) {
    Result<gl::EglContext> egl = gl::EglContext::create(o_.device);
    if (!egl) return egl.error();
    egl_ = std::move(*egl);
  } else {
    Result<Window> window = Window::create(o_.width, o_.height);
    if (!window) return window.error();
    window_.emplace(std::move(*window));
    Result<Overlay> overlay = Overlay::create();
    if (!overlay) return overlay.error();
    overlay_.emplace(std::move(*overlay));
  }
  Result<FrameRenderer> renderer = FrameRenderer::create(kAtlasEdge, atlas_layers(o_));
  if (!renderer) return renderer.error();
  renderer_.emplace(renderer.take());
  Result<FrameTarget> target = FrameTarget::create(o_.width, o_.height, o_.msaa);
  if (!target) return target.error();
  target_.emplace(target.take());
  return {};
}

void Viewer::open_session() {
  ClientOptions options;
  options.tau_px = o_.tau_px;
  options.targets = o_.targets;
  options.mesh_radii = o_.mesh_radii;
  options.method = o_.method;
  options.atlas_edge = kAtlasEdge;
  options.atlas_layers = atlas_layers(o_);
  options.mesh_budget_bytes = static_cast<std::size_t>(o_.mesh_mb) * 1024 * 1024;
  options.relight = o_.relight;
  options.token = o_.token;
  options.shadows = o_.shadows == "on";
  options.animation = o_.animation == "on";
  options.trace = !o_.trace_file.empty();
  // Measured: a pixel of marching costs a CPU rasteriser some 0.3 us, a GPU next to nothing.
  const std::string renderer_name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const bool software = renderer_name.find("llvmpipe") != std::string::npos;
  options.march_budget_px = o_.march_kpx >= 0 ? o_.march_kpx * 1000 : software ? 200e3 : 1e9;
  TileSink sink;
  sink.tile = [this](const TileRecord& record, const TilePixels& pixels) {
    renderer_->upload(record, pixels);
  };
  sink.shadow = [this](const ShadowRecord& record, const std::vector<std::uint8_t>& shares) {
    renderer_->upload_shadow(record, shares);
  };
  sink.caster = [this](const ShadowRecord& record, const std::vector<std::uint8_t>& codes) {
    renderer_->upload_caster(record, codes);
  };
  sink.mesh = [this](std::uint32_t object, std::uint8_t lod, ObjectModel model) {
    const Result<void> added = renderer_->add_mesh(object, lod, std::move(model));
    if (!added) spdlog::error("{}", added.error().line());
  };
  sink.image = [this](std::uint32_t index, const Image& image) {
    renderer_->add_image(session_->scene(), index, image);
  };
  sink.drop = [this](const AssetId& id) { renderer_->drop(session_->scene(), id); };
  sink.scene = [this](const SceneView& scene) {
    const Result<void> ready = renderer_->reset(scene);
    if (!ready) spdlog::warn("{}", ready.error().line());
    blends_ = scene.blends();
  };
  Link& link = modelled_ ? static_cast<Link&>(*modelled_) : *native_;
  session_ = std::make_unique<ClientSession>(link, options, sink);
}

Result<void> Viewer::open_link() {
  if (o_.virtual_time) {
    auto clock = std::make_unique<VirtualClock>();
    virtual_clock_ = clock.get();
    clock_ = std::move(clock);
  } else {
    clock_ = std::make_unique<SteadyClock>();
  }
  Result<ServerUrl> url = parse_url(o_.url);
  if (!url) return url.error();
  native_ = std::make_unique<NativeLink>(*url);
  if (o_.net || o_.virtual_time) {
    const auto wait = [this] {
      native_->wait_message(kReplyTimeoutMs);
      return native_->connected();
    };
    modelled_ = std::make_unique<ModelledLink>(*native_, *clock_, o_.net.value_or(NetModel{}),
                                               o_.virtual_time, wait);
  }
  if (!native_->wait_connected(static_cast<int>(o_.connect_timeout_s * 1000))) {
    const std::string problem = native_->last_problem();
    return make_error(ErrorId::kNetworkConnect,
                      "no server answers at " + o_.url + (problem.empty() ? "" : ": " + problem),
                      "start one with: mirage-server builtin:forest");
  }
  return {};
}

Result<void> Viewer::wait_for_scene() {
  const SteadyClock patience;
  const auto limit = static_cast<std::int64_t>(o_.connect_timeout_s * 1e6) + 20'000'000;
  while (!session_->scene().complete()) {
    if (Result<void> received = session_->receive(now_us()); !received) return received;
    if (session_->scene().complete()) break;
    if (native_->last_close_code() == close_code(ErrorId::kAuth)) {
      return make_error(ErrorId::kAuth, "the server refused the token", "--token-file FILE");
    }
    if (const std::optional<Error> refused = native_->refusal()) {
      return make_error(refused->id, "the server's scene was refused: " + refused->text,
                        "are server and viewer of one version?");
    }
    const bool late = patience.now_us() > limit;
    if (late || (!native_->connected() && native_->last_close_code() != 0)) {
      return make_error(ErrorId::kNetworkClosed,
                        "the server did not describe its scene: " + native_->last_problem());
    }
    if (virtual_clock_) virtual_clock_->advance_to_us(virtual_clock_->now_us() + 1000);
    if (!virtual_clock_) native_->wait_message(20);
  }
  const SceneView& scene = session_->scene();
  if (!o_.path.empty()) {
    Result<CameraPath> path =
        CameraPath::create(o_.path, scene.home, scene.bounds_center, scene.bounds_radius);
    if (!path) return path.error();
    path_.emplace(path.take());
  }
  Result<LightScript> light = LightScript::create(o_.light);
  if (!light) return light.error();
  light_.emplace(light.take());
  pose_ = look_at(scene.home.eye, scene.home.target);
  spdlog::info("{}: {} objects, {} instances, {} triangles on the server", scene.name,
               scene.objects.size(), scene.instances.size(), scene.triangles);
  return {};
}

Pose Viewer::next_pose(std::int64_t now, double real_seconds) {
  if (path_) {
    pose_ = path_->at(static_cast<double>(now - start_us_) * 1e-6);
  } else if (window_) {
    window_->steer(pose_, real_seconds, session_->scene().home.walk_speed_mps * 2);
  }
  return pose_;
}

Result<void> Viewer::fit_target() {
  int w = target_->width(), h = target_->height();
  if (window_) window_->framebuffer_size(w, h);
  const bool same = w == target_->width() && h == target_->height();
  if (w < 1 || h < 1 || (same && blends_ == target_->blends())) return {};
  Result<FrameTarget> target = FrameTarget::create(w, h, o_.msaa, blends_);
  if (!target) return target.error();
  target_.emplace(target.take());
  return {};
}

Result<void> Viewer::one_frame(std::int64_t frame) {
  const std::int64_t began = real_clock_.now_us();
  const std::int64_t now = now_us();
  if (Result<void> received = session_->receive(now); !received) {
    spdlog::warn("{}", received.error().line());
  }
  if (native_->connected() != link_was_up_) {
    link_was_up_ = native_->connected();
    spdlog::warn("{}", link_was_up_ ? "server is back"
                                    : "server is gone: showing what is here, reconnecting");
  }
  if (Result<void> resized = fit_target(); !resized) return resized;
  const SceneView& scene = session_->scene();
  const std::optional<Lighting> light =
      light_->at(static_cast<double>(now - start_us_) * 1e-6, scene.lighting);
  if (light && (!last_light_ || !same_lighting(*light, *last_light_))) {
    session_->set_lighting(*light, now);
    last_light_ = light;
  }
  Camera camera;
  camera.pose = next_pose(now, smooth_ms_ * 1e-3);
  camera.fov_y = o_.fov_degrees * 0.017453292519943295;
  camera.width = static_cast<std::uint32_t>(target_->width());
  camera.height = static_cast<std::uint32_t>(target_->height());
  camera.fit_depth_range(scene.bounds_center, scene.bounds_radius);
  const DrawList list = session_->frame(camera, now, window_ ? window_->cursor_px() : std::nullopt);
  renderer_->draw(*target_, camera, scene, list, session_->lighting());
  if (window_) {
    target_->show();
    if (window_->overlay()) {
      overlay_->draw(overlay_text(list, now), target_->width(), target_->height());
    }
    window_->present();
  }
  glFinish();
  if (!list.impostors.empty() || !list.meshes.empty()) stats_.first_image(now);
  const double real_ms = static_cast<double>(real_clock_.now_us() - began) / 1000.0;
  if (session_->light_changed()) stats_.add_light_lag(list, scene);
  stats_.add_frame(list, renderer_->draw_calls(), virtual_clock_ ? 1000.0 / o_.fps : real_ms,
                   real_ms, now);
  stats_.note_traffic(modelled_ ? modelled_->traffic() : native_->traffic(), now - start_us_);
  smooth_ms_ += 0.1 * (real_ms - smooth_ms_);
  if (!virtual_clock_) session_->note_frame_ms(smooth_ms_);
  if (!o_.out_dir.empty()) {
    const std::string path = fmt::format("{}/frame_{:05}.png", o_.out_dir, frame);
    const Result<void> written =
        write_png(path, target_->width(), target_->height(), target_->read());
    if (!written) return written;
  }
  if (o_.reference_every > 0 && frame > 0 && frame % o_.reference_every == 0) {
    const std::int64_t paused_at = clock_->now_us();
    if (Result<void> compared = compare(camera, list); !compared) return compared;
    paused_us_ += clock_->now_us() - paused_at;
  }
  return {};
}

Result<void> Viewer::compare(const Camera& camera, const DrawList& list) {
  const std::vector<std::uint8_t> drawn = target_->read();
  session_->ask_reference(camera, static_cast<std::uint32_t>(o_.reference_supersample));
  const SteadyClock patience;
  std::optional<ReferenceFrame> reference;
  while (!(reference = session_->take_reference())) {
    if (session_->reference_refused()) {
      return make_error(ErrorId::kComparison, "the server renders no references",
                        "it was started with --no-reference, or the frame is too large");
    }
    if (!native_->connected() || patience.now_us() > kReferenceTimeoutMs * 1000ll) {
      return make_error(ErrorId::kNetworkTimeout, "no reference frame came");
    }
    if (!modelled_) native_->wait_message(100);
    if (Result<void> received = session_->receive(now_us()); !received) return received;
  }
  return comparison_.add({camera, list, session_->scene(), drawn, *reference,
                          session_->frame_number(), o_.reference_supersample},
                         stats_, o_.out_dir);
}

std::string Viewer::overlay_text(const DrawList& list, std::int64_t now) const {
  double bound = 0;
  std::vector<float> ages_ms;
  for (const DrawnImpostor& drawn : list.impostors) {
    if (std::isfinite(drawn.bound_px)) bound = std::max(bound, drawn.bound_px);
    ages_ms.push_back(static_cast<float>(now - drawn.tile->received_us) / 1000.0f);
  }
  const LinkTraffic traffic = modelled_ ? modelled_->traffic() : native_->traffic();
  return fmt::format(
      "{:.0f} fps, {} draw calls\n{} impostors, {} meshes, {} without image\nbound {:.1f} px "
      "worst, "
      "{} of {} over tau\ntile age {:.1f} s median\n{:.2f} MB down, round trip {} ms{}{}",
      1000.0 / std::max(smooth_ms_, 0.1), renderer_->draw_calls(), list.impostors.size(),
      list.meshes.size(), list.placeholders.size(), bound, list.over_tau, list.visible,
      quantile(ages_ms, 0.5) / 1000.0f, static_cast<double>(traffic.bytes_down) * 1e-6,
      session_->round_trip_us() / 1000,
      session_->scene().geometry ? "" : "\nthe server keeps its geometry: images only",
      native_->connected() ? "" : "\nOFFLINE: showing what is here, reconnecting");
}

void Viewer::pace(std::int64_t frame) {
  const std::int64_t due = start_us_ + frame_us(frame + 1);
  if (virtual_clock_) {
    virtual_clock_->advance_to_us(due);
    return;
  }
  const std::int64_t left = due - now_us();
  if (o_.offscreen && left > 0) std::this_thread::sleep_for(std::chrono::microseconds(left));
}

Result<void> Viewer::frame_loop() {
  start_us_ = now_us();
  for (std::int64_t frame = 0; o_.frames == 0 || frame < o_.frames; ++frame) {
    if (window_ && !window_->poll()) break;
    if (Result<void> done = one_frame(frame); !done) return done;
    if (o_.offscreen && o_.frames >= 100 && frame % 60 == 59) {
      spdlog::info("frame {} of {}", frame + 1, o_.frames);
    }
    pace(frame);
  }
  return {};
}

Result<void> write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return make_error(ErrorId::kIo, "cannot write '" + path + "'");
  return {};
}

Result<void> Viewer::finish() {
  SessionStats::Final end;
  end.traffic = modelled_ ? modelled_->traffic() : native_->traffic();
  end.tiles = session_->tiles();
  end.prediction = session_->predictor().error();
  end.gpu_bytes = renderer_->gpu_bytes() + target_->gpu_bytes();
  end.duration_us = now_us() - start_us_;
  end.scene = session_->scene().name;
  end.server = session_->scene().renderer;
  end.renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  end.method = o_.method_name;
  end.tau_px = o_.tau_px;
  end.wall_s = static_cast<double>(real_clock_.now_us()) * 1e-6;
  std::fputs(stats_.table(end).c_str(), stdout);
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "GL error " + std::to_string(error));
  }
  if (!o_.trace_file.empty()) {
    if (Result<void> r = write_text(o_.trace_file, trace_json(session_->lives())); !r) return r;
  }
  if (o_.stats_file.empty()) return {};
  if (Result<void> r = write_text(o_.stats_file, stats_.json(end)); !r) return r;
  std::filesystem::path apart(o_.stats_file);
  apart.replace_extension(".real_time.json");
  return write_text(apart.string(), stats_.real_time_json(end));
}

Result<void> Viewer::run() {
  if (!o_.out_dir.empty()) {
    std::error_code failed;
    std::filesystem::create_directories(o_.out_dir, failed);
    if (failed) return make_error(ErrorId::kIo, "cannot make directory '" + o_.out_dir + "'");
  }
  if (Result<ServerUrl> url = parse_url(o_.url); !url) return url.error();
  // Shaders first: a server waits only so long for the hello of a client that has connected.
  if (Result<void> graphics = open_graphics(); !graphics) return graphics;
  if (Result<void> link = open_link(); !link) return link;
  open_session();
  if (Result<void> scene = wait_for_scene(); !scene) return scene;
  if (Result<void> looped = frame_loop(); !looped) return looped;
  return finish();
}

}  // namespace

Result<void> run_viewer(const ViewOptions& options) {
  Viewer viewer(options);
  return viewer.run();
}

}  // namespace mirage

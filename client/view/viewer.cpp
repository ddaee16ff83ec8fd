#include "client/view/viewer.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <thread>

#include "client/door/client.h"
#include "client/draw/frame_renderer.h"
#include "client/draw/insight.h"
#include "client/draw/presenter.h"
#include "client/frame/camera_path.h"
#include "client/frame/planned_frame.h"
#include "client/host/client_host.h"
#include "client/host/frame_recorder.h"
#include "client/host/light_script.h"
#include "client/host/png.h"
#include "client/host/stop_signal.h"
#include "client/native/native_link.h"
#include "client/price/cost_fit.h"
#include "client/scene/scene_view.h"
#include "client/screen/pilot.h"
#include "client/screen/screen.h"
#include "client/screen/viewer_defaults.h"
#include "client/session/client_session.h"
#include "client/view/choice_log.h"
#include "client/view/comparison.h"
#include "client/view/overlay.h"
#include "client/view/overlay_text.h"
#include "client/view/results.h"
#include "client/view/session_stats.h"
#include "client/view/window.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/tile_key.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/egl_context.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

class Viewer {
 public:
  Viewer(const ViewOptions& options, const StopSignal& stop) : o_(options), stop_(stop) {}
  Result<void> run();

 private:
  Result<void> open_graphics();
  void make_host();
  void price_frames();
  Result<void> meet_scene();
  Result<void> frame_loop();
  Result<void> one_frame(std::int64_t frame);
  Result<void> compare();
  Result<void> finish();
  Result<void> fit_target();
  double frame_budget_ms() const;
  void draw(FrameStep step);
  void note_scene();
  void note_link();
  void set_light(std::int64_t now);
  void note_drawn(const DrawList& list);
  void note_frame(const DrawList& list, double frame_ms, std::int64_t now);
  void receive(std::int64_t now);
  void record_frame(const DrawList& list);
  bool over(std::int64_t frame) const;
  Camera camera_at(const Pose& pose) const;
  void steer(double seconds);
  void choose();
  Pose next_pose(std::int64_t now_us, double real_seconds);
  void tell_progress(std::int64_t done);
  void pace(std::int64_t frame);
  bool next_events();
  Result<std::int64_t> show(std::int64_t now);
  void price(std::int64_t began_us, std::int64_t draw_began_us, std::int64_t shown_us);
  std::int64_t now_us() const { return host_->now_us(); }
  ClientSession& session() { return host_->session(); }
  const ClientSession& session() const { return host_->session(); }
  Screen& screen() { return client_.screen(); }
  const Screen& screen() const { return client_.screen(); }
  const NativeLink& native() const { return host_->native(); }
  std::int64_t frame_us(std::int64_t frame) const {
    return std::llround(static_cast<double>(frame) * 1e6 / o_.fps);
  }

  const ViewOptions& o_;
  const StopSignal& stop_;
  SteadyClock real_clock_;
  FrameRecorder recorder_{real_clock_};
  std::int64_t start_us_ = 0;
  std::optional<Window> window_;
  gl::EglContext egl_;
  std::optional<Presenter> presenter_;  // for the window
  std::optional<Insight> insight_;      // for the window
  Client client_;
  std::unique_ptr<ClientHost> host_;
  std::optional<CameraPath> path_;
  std::optional<LightScript> light_;
  Pilot pilot_;
  ChoiceLog choice_{o_.scene.choice};
  Pose pose_;
  SessionStats stats_;
  std::optional<Lighting> last_light_;
  bool link_was_up_ = true;
  bool resting_ = false;     // the last frame changed nothing, and no further one would
  bool frame_kept_ = false;  // the last frame kept the picture
  std::optional<Overlay> overlay_;
  double smooth_ms_ = 0;
  double told_s_ = 0;    // real time of the last line about the progress
  bool priced_ = false;  // the time of the frame under way tells prices
  double model_ms_ = 0;  // time of the last drawn frame, by the device model
  std::uint64_t programs_at_scene_ = 0, programs_in_draws_ = 0;
  Comparison comparison_;
};

constexpr double kRadians = 0.017453292519943295;  // of a degree
constexpr double kToldEveryS = 5;
constexpr double kKeptFrameS = 1.0 / 60;  // replaces the display's pace, which needs a swap
constexpr double kRestS = 60;             // an event comes sooner or not at all

Result<void> Viewer::open_graphics() {
  if (o_.offscreen) {
    Result<gl::EglContext> egl = gl::EglContext::create(o_.graphics.device, o_.graphics.gles);
    if (!egl) return egl.error();
    egl_ = std::move(*egl);
  } else {
    Result<Window> window = Window::create(o_.width, o_.height);
    if (!window) return window.error();
    window_.emplace(std::move(*window));
    Result<Overlay> overlay = Overlay::create();
    if (!overlay) return overlay.error();
    overlay_.emplace(std::move(*overlay));
    Result<Presenter> presenter = Presenter::create();
    if (!presenter) return presenter.error();
    presenter_.emplace(presenter.take());
    Result<Insight> insight = Insight::create();
    if (!insight) return insight.error();
    insight_.emplace(insight.take());
  }
  std::set<DrawMethod> flat = kAutoFlatMethods;
  if (kFlatMethods.count(o_.method.method) > 0) flat.insert(o_.method.method);
  return client_.attach({o_.width, o_.height, kAtlasEdge, atlas_layers(o_.atlas_mb), flat});
}

void Viewer::make_host() {
  HostOptions host;
  host.url = o_.url;
  host.ca_file = o_.ca_file;
  host.virtual_time = o_.virtual_time;
  host.net = o_.net;
  host.connect_timeout_s = o_.connect_timeout_s;
  if (window_) host.wake = &Window::wake;
  ClientOptions& options = host.session;
  options.tau_px = o_.tau_px;
  options.targets = o_.targets;
  options.frame_ms = frame_budget_ms();
  options.samples = o_.msaa;
  options.mesh_radii = o_.mesh_radii;
  if (o_.march_kpx >= 0) options.march_budget_px = 1000 * o_.march_kpx;
  options.method = o_.method;
  options.mesh_budget_bytes = static_cast<std::size_t>(o_.mesh_mb) * 1024 * 1024;
  options.upload_budget_bytes = static_cast<std::size_t>(o_.upload_kb) * 1024;
  options.relight = o_.relight;
  options.token = o_.token;
  options.codec = codec_from_name(o_.codec_name);
  options.shadows = o_.scene.shadows == "on";
  options.animation = o_.scene.animation == "on";
  options.choice = choice_.asked();
  options.views = o_.views;
  options.screen.fov_y = o_.fov_degrees * kRadians;
  options.screen.width = static_cast<std::uint32_t>(screen().width());
  options.screen.height = static_cast<std::uint32_t>(screen().height());
  options.trace = !o_.trace_file.empty();
  host_ = std::make_unique<ClientHost>(host, client_);
}

// Gives frames prices from now on: those of the device model, or measured ones.
void Viewer::price_frames() {
  if (o_.device_model) session().set_prices(*o_.device_model);
  if (o_.virtual_time) return;
  client_.set_prices(*device_model(gl::is_software() ? "software" : "laptop"));
}

// Returns the budget of a frame. By default it is the display's pace, or 20 frames a second on a
// software renderer. On virtual time frames take no time.
double Viewer::frame_budget_ms() const {
  if (o_.frame_ms >= 0) return o_.frame_ms;
  if (o_.virtual_time) return 0;
  if (gl::is_software()) return kSoftwareFrameMs;
  return window_ ? window_->refresh_ms() : 0;
}

Result<void> Viewer::meet_scene() {
  if (Result<void> told = host_->wait_for_picture(); !told) return told;
  const SceneView& scene = session().scene();
  if (!o_.path.empty()) {
    Result<CameraPath> path =
        CameraPath::create(o_.path, scene.home, scene.bounds_center, scene.bounds_radius);
    if (!path) return path.error();
    path_.emplace(path.take());
  }
  Result<LightScript> light = LightScript::create(o_.light);
  if (!light) return light.error();
  light_.emplace(light.take());
  pose_ = home_pose(scene.home, camera_at({}));
  pilot_.meet(scene);
  return {};
}

// Notes the scene once it is complete; until then only a view of it can be drawn.
void Viewer::note_scene() {
  const SceneView& scene = session().scene();
  if (programs_at_scene_ != 0 || !scene.complete()) return;
  programs_at_scene_ = gl::programs_compiled();
  spdlog::info("{}: {} objects, {} instances, {} triangles on the server", scene.name,
               scene.objects.size(), scene.instances.size(), scene.triangles);
}

Camera Viewer::camera_at(const Pose& pose) const {
  return client_.camera(pose, o_.fov_degrees * kRadians);
}

// Asks for the next clip or variant, if a key said so.
void Viewer::choose() {
  const bool clip = window_->take(WindowCommand::kNextClip);
  const bool variant = window_->take(WindowCommand::kNextVariant);
  if (!choice_.ask_next(session().scene().choices, clip, variant)) return;
  session().choose(choice_.asked());
  host_->reconnect();
}

// Moves the eye by what a person did at the window.
void Viewer::steer(double seconds) {
  if (window_->take(WindowCommand::kSteerMode)) {
    const bool orbits = pilot_.mode() == SteerMode::kOrbit;
    pilot_.set_mode(orbits ? SteerMode::kWalk : SteerMode::kOrbit);
  }
  if (window_->take(WindowCommand::kFly)) {
    pilot_.set_flies(!pilot_.flies());
    spdlog::info("{}", pilot_.flies() ? "flying, through everything" : "feet on the ground");
  }
  const Steering by = window_->take_steering(seconds);
  const Camera camera = camera_at(pose_);
  if (const std::optional<glm::dvec2> place = window_->take_aim()) {
    if (const auto seen = seen_at(session().scene(), camera, *place)) pilot_.aim(seen->point);
  }
  if (by.moves()) pilot_.look_ahead(session().scene(), camera);
  pilot_.steer(by, camera.fov_y, session().ground(), pose_);
  if (pilot_.needs_ground()) session().want_ground(pose_.eye, now_us());
}

Pose Viewer::next_pose(std::int64_t now, double real_seconds) {
  if (window_) session().play(!window_->stopped(), now);
  if (path_) {
    pose_ = path_->at(static_cast<double>(now - start_us_) * 1e-6);
  } else if (window_) {
    choose();
    steer(real_seconds);
  }
  return pose_;
}

Result<void> Viewer::fit_target() {
  int w = screen().width(), h = screen().height();
  if (window_) window_->framebuffer_size(w, h);
  return client_.resize(w, h);
}

void Viewer::draw(FrameStep step) {
  client_.draw();
  if (step == FrameStep::kRefine) {
    const PlannedFrame& planned = client_.planned();
    if (o_.device_model) model_ms_ = o_.device_model->ms_of(work_of(planned, planned.camera, 1));
    recorder_.lap(FrameStage::kDraw);
  }
  priced_ = false;
  if (step != FrameStep::kDraw) return;
  const std::uint64_t compiled = client_.compiled();
  if (compiled == 0) recorder_.lap(FrameStage::kDraw);
  glFinish();
  recorder_.lap(compiled > 0 ? FrameStage::kCompile : FrameStage::kFinish);
  programs_in_draws_ += compiled;
  if (o_.device_model) {
    model_ms_ = o_.device_model->ms_of(client_.drawn_work());
    session().note_frame_ms(model_ms_);
  }
  priced_ = client_.prices() && compiled == 0;
}

// Learns what the last frame took. A software renderer copies the picture to the window itself;
// elsewhere presenting only waits for the display.
void Viewer::price(std::int64_t began_us, std::int64_t draw_began_us, std::int64_t shown_us) {
  if (!priced_) return;
  const std::int64_t end_us = gl::is_software() ? real_clock_.now_us() : shown_us;
  const double ms = static_cast<double>(end_us - draw_began_us) * 1e-3;
  stats_.note_price(client_.prices()->model().ms_of(client_.drawn_work()), ms);
  client_.done(ms, static_cast<double>(draw_began_us - began_us) * 1e-3);
}

// Returns when the picture was ready to be presented.
Result<std::int64_t> Viewer::show(std::int64_t now) {
  const PlannedFrame& planned = client_.planned();
  presenter_->show(screen().shown());
  gl::encode_srgb(false);
  Result<void> tinted = insight_->draw(static_cast<InsightLayer>(window_->layer()),
                                       client_.renderer(), planned.camera, planned, now);
  gl::encode_srgb(true);
  if (!tinted) return tinted.error();
  if (window_->overlay()) {
    const OverlayFigures figures{smooth_ms_, client_.renderer().draw_calls()};
    overlay_->draw(overlay_text(*host_, planned.list, figures, now), screen().width(),
                   screen().height());
  }
  glFinish();
  const std::int64_t shown_us = real_clock_.now_us();
  window_->present();
  return shown_us;
}

void Viewer::note_link() {
  if (native().connected() == link_was_up_) return;
  link_was_up_ = native().connected();
  spdlog::warn(
      "{}", link_was_up_ ? "server is back" : "server is gone: showing what is here, reconnecting");
}

void Viewer::set_light(std::int64_t now) {
  const std::optional<Lighting> light =
      light_->at(static_cast<double>(now - start_us_) * 1e-6, session().scene().lighting);
  if (!light || (last_light_ && same_lighting(*light, *last_light_))) return;
  session().set_lighting(*light, now);
  last_light_ = light;
}

void Viewer::note_drawn(const DrawList& list) {
  const std::int64_t drawn_us = now_us();
  session().note_drawn(drawn_us);
  const bool own_images = !list.impostors.empty() || !list.meshes.empty();
  if (own_images) stats_.first_image(drawn_us);
  if (own_images || list.view) stats_.first_picture(drawn_us);
}

void Viewer::note_frame(const DrawList& list, double frame_ms, std::int64_t now) {
  if (session().light_changed()) stats_.add_light_lag(list, session().scene());
  stats_.note_plan(session().plan());
  stats_.add_frame(list, client_.renderer().draw_calls(), frame_ms, now);
  if (const auto use = host_->link_use()) stats_.note_use(session().first_waits(), *use);
  stats_.note_traffic(host_->traffic(), now - start_us_);
  stats_.note_asked(session().tiles().asked, now - start_us_);
}

void Viewer::receive(std::int64_t now) {
  recorder_.begin();
  const double uploaded_ms = client_.upload_ms();
  if (Result<void> received = client_.update(now); !received) {
    spdlog::warn("{}", received.error().line());
  }
  recorder_.lap(FrameStage::kReceive, client_.upload_ms() - uploaded_ms);
}

void Viewer::record_frame(const DrawList& list) {
  RecordedFrame frame;
  const FramePlan& plan = session().plan();
  frame.budget_ms = static_cast<float>(plan.budget_ms());
  frame.scale = static_cast<float>(plan.setting().scale);
  frame.visible = static_cast<std::uint32_t>(list.visible);
  frame.placeholders = static_cast<std::uint32_t>(list.placeholders.size());
  recorder_.end(frame);
}

Result<void> Viewer::one_frame(std::int64_t frame) {
  const std::int64_t began = real_clock_.now_us();
  const std::int64_t now = now_us();
  receive(now);
  note_scene();
  choice_.note(session().scene().choices);
  note_link();
  if (Result<void> resized = fit_target(); !resized) return resized;
  set_light(now);
  const Result<FrameStep> step = client_.plan(camera_at(next_pose(now, smooth_ms_ * 1e-3)), now);
  if (!step) return step.error();
  recorder_.lap(FrameStage::kPlan);
  const DrawList& list = client_.planned().list;
  const bool drawn = *step != FrameStep::kKeep;
  frame_kept_ = !drawn;
  resting_ = !drawn && session().at_rest();
  const std::int64_t draw_began_us = real_clock_.now_us();
  draw(*step);
  stats_.note_gpu(client_.renderer().gpu_bytes(), screen().gpu_bytes());
  std::int64_t shown_us = real_clock_.now_us();
  if (window_ && (window_->take_refresh() || drawn)) {
    const Result<std::int64_t> shown = show(now);
    if (!shown) return shown.error();
    shown_us = *shown;
  }
  glFinish();
  price(began, draw_began_us, shown_us);
  recorder_.lap(FrameStage::kShow);
  note_drawn(list);
  const double real_ms = static_cast<double>(real_clock_.now_us() - began) / 1000.0;
  const double frame_ms = !host_->virtual_clock() ? real_ms
                          : o_.device_model       ? (drawn ? model_ms_ : 0)
                                                  : 1000.0 / o_.fps;
  note_frame(list, frame_ms, now);
  if (drawn) stats_.note_drawn(real_ms);
  if (drawn) record_frame(list);
  if (drawn) smooth_ms_ += 0.1 * (frame_ms - smooth_ms_);
  if (!o_.out_dir.empty()) {
    const std::string path = fmt::format("{}/frame_{:05}.png", o_.out_dir, frame);
    const Result<void> written =
        write_png(path, screen().width(), screen().height(), screen().shown().read());
    if (!written) return written;
  }
  if (o_.reference_every > 0 && frame > 0 && frame % o_.reference_every == 0) {
    const std::int64_t paused_at = host_->clock().now_us();
    if (Result<void> compared = compare(); !compared) return compared;
    host_->leave_out_since(paused_at);  // comparing is no part of the session
  }
  return {};
}

Result<void> Viewer::compare() {
  const PlannedFrame& planned = client_.planned();
  const std::vector<std::uint8_t> drawn = screen().shown().read();
  const Result<ReferenceFrame> reference =
      host_->reference(planned.camera, static_cast<std::uint32_t>(o_.reference_supersample));
  if (!reference) return reference.error();
  return comparison_.add(
      {planned, drawn, *reference, session().frame_number(), o_.reference_supersample}, stats_,
      o_.out_dir);
}

// A window at rest sleeps until somebody touches it or something arrives. A path, a light that
// moves by itself and a modelled link need the clock.
bool Viewer::next_events() {
  if (resting_ && !path_ && !host_->modelled() && light_->fixed()) return window_->wait(kRestS);
  return frame_kept_ ? window_->wait(kKeptFrameS) : window_->poll();
}

void Viewer::pace(std::int64_t frame) {
  const std::int64_t due = start_us_ + frame_us(frame + 1);
  if (VirtualClock* clock = host_->virtual_clock()) {
    clock->advance_to_us(due);
    return;
  }
  const std::int64_t left = due - now_us();
  if (o_.offscreen && left > 0) std::this_thread::sleep_for(std::chrono::microseconds(left));
}

// Tells how far a long run has come, now and then.
void Viewer::tell_progress(std::int64_t done) {
  const double now_s = static_cast<double>(real_clock_.now_us()) * 1e-6;
  if (told_s_ == 0) told_s_ = now_s;
  if (now_s - told_s_ < kToldEveryS) return;
  told_s_ = now_s;
  if (o_.length.frames > 0) {
    spdlog::info("frame {} of {}", done, o_.length.frames);
  } else {
    spdlog::info("{} frames", done);
  }
}

bool Viewer::over(std::int64_t frame) const {
  const double seconds = static_cast<double>(now_us() - start_us_) * 1e-6;
  return stop_.stopped() || (o_.length.frames > 0 && frame >= o_.length.frames) ||
         (o_.length.seconds > 0 && seconds >= o_.length.seconds);
}

Result<void> Viewer::frame_loop() {
  start_us_ = now_us();
  stop_.begin_frames();
  for (std::int64_t frame = 0; !over(frame); ++frame) {
    if (window_ && !next_events()) break;
    if (Result<void> done = one_frame(frame); !done) return done;
    if (o_.offscreen) tell_progress(frame + 1);
    pace(frame);
  }
  return {};
}

Result<void> Viewer::finish() {
  SessionStats::Final end = end_of(*host_);
  end.atlas_budget = static_cast<std::size_t>(o_.atlas_mb) << 20;
  end.geometry_budget = static_cast<std::size_t>(o_.mesh_mb) << 20;
  end.upload_budget = static_cast<std::size_t>(o_.upload_kb) << 10;
  end.method = o_.method_name;
  end.tau_px = o_.tau_px;
  end.samples = screen().samples();
  end.programs = gl::programs_compiled();
  end.programs_after_scene = end.programs - programs_at_scene_;
  end.programs_in_draws = programs_in_draws_;
  end.duration_us = now_us() - start_us_;
  end.renderer = gl::renderer_name();
  end.wall_s = static_cast<double>(real_clock_.now_us()) * 1e-6;
  std::fputs(stats_.table(end).c_str(), stdout);
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "GL error " + std::to_string(error));
  }
  return write_results({o_.trace_file, o_.explain_file, o_.stats_file}, stats_, end, session(),
                       recorder_);
}

Result<void> Viewer::run() {
  if (!o_.out_dir.empty()) {
    std::error_code failed;
    std::filesystem::create_directories(o_.out_dir, failed);
    if (failed) return make_error(ErrorId::kIo, "cannot make directory '" + o_.out_dir + "'");
  }
  // Shaders are made first, because a server waits for a limited time for the hello of a client.
  if (Result<void> graphics = open_graphics(); !graphics) return graphics;
  make_host();
  if (Result<void> link = host_->open(); !link) return link;
  if (const std::optional<Pose> start = CameraPath::start_of(o_.path)) session().start_at(*start);
  price_frames();
  if (Result<void> scene = meet_scene(); !scene) return scene;
  if (Result<void> looped = frame_loop(); !looped) return looped;
  return finish();
}

}  // namespace

Result<void> run_viewer(const ViewOptions& options) {
  // A window that sleeps wakes up. Without one there is nothing to wake.
  const StopSignal stop(options.offscreen ? std::function<void()>() : &Window::wake);
  Viewer viewer(options, stop);
  return viewer.run();
}

}  // namespace mirage

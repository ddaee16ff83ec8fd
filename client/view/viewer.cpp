#include "client/view/viewer.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <filesystem>
#include <thread>

#include "client/door/client.h"
#include "client/frame/planned_frame.h"
#include "client/host/client_host.h"
#include "client/host/stop_signal.h"
#include "client/price/cost_fit.h"
#include "client/screen/screen.h"
#include "client/screen/viewer_defaults.h"
#include "client/session/client_session.h"
#include "client/view/course.h"
#include "client/view/run_log.h"
#include "client/view/surface.h"
#include "protocol/impostor/tile_key.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

constexpr double kRadians = 0.017453292519943295;  // of a degree
constexpr double kKeptFrameS = 1.0 / 60;  // replaces the display's pace, which needs a swap
constexpr double kRestS = 60;             // an event comes sooner or not at all

class Viewer {
 public:
  Viewer(const ViewOptions& options, const StopSignal& stop) : o_(options), stop_(stop) {}
  Result<void> run();

 private:
  Result<void> open_graphics();
  HostOptions host_options();
  void price_frames();
  Result<void> frame_loop();
  Result<void> one_frame(std::int64_t frame);
  double frame_budget_ms();
  void draw(FrameStep step);
  void receive(std::int64_t now);
  bool over(std::int64_t frame) const;
  Camera camera_at(const Pose& pose) const {
    return client_.camera(pose, o_.fov_degrees * kRadians);
  }
  void pace(std::int64_t frame);
  bool next_events();
  void price(std::int64_t began_us, std::int64_t draw_began_us, std::int64_t shown_us);
  double frame_ms(double real_ms, bool drawn) const;
  ClientSession& session() { return host_->session(); }
  std::int64_t frame_us(std::int64_t frame) const {
    return std::llround(static_cast<double>(frame) * 1e6 / o_.fps);
  }

  const ViewOptions& o_;
  const StopSignal& stop_;
  SteadyClock real_clock_;
  RunLog log_{o_, real_clock_};
  std::int64_t start_us_ = 0;
  Surface surface_;
  Client client_;
  std::unique_ptr<ClientHost> host_;
  Course course_{o_, [this](const Pose& pose) { return camera_at(pose); }};
  bool resting_ = false;     // the last frame changed nothing, and no further one would
  bool frame_kept_ = false;  // the last frame kept the picture
  double smooth_ms_ = 0;
  bool priced_ = false;  // the time of the frame under way tells prices
  double model_ms_ = 0;  // time of the last drawn frame, by the device model
};

Result<void> Viewer::open_graphics() {
  if (Result<void> opened = surface_.open(o_); !opened) return opened;
  std::set<DrawMethod> flat = kAutoFlatMethods;
  if (kFlatMethods.count(o_.method.method) > 0) flat.insert(o_.method.method);
  return client_.attach({o_.width, o_.height, kAtlasEdge, atlas_layers(o_.atlas_mb), flat});
}

HostOptions Viewer::host_options() {
  HostOptions host;
  host.url = o_.url;
  host.ca_file = o_.ca_file;
  host.virtual_time = o_.virtual_time;
  host.net = o_.net;
  host.connect_timeout_s = o_.connect_timeout_s;
  if (surface_.window()) host.wake = &Window::wake;
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
  options.choice = course_.choice();
  options.views = o_.views;
  options.screen.fov_y = o_.fov_degrees * kRadians;
  options.screen.width = static_cast<std::uint32_t>(client_.screen().width());
  options.screen.height = static_cast<std::uint32_t>(client_.screen().height());
  options.trace = !o_.trace_file.empty();
  return host;
}

// Gives frames prices from now on: those of the device model, or measured ones.
void Viewer::price_frames() {
  if (o_.device_model) session().set_prices(*o_.device_model);
  if (o_.virtual_time) return;
  client_.set_prices(*device_model(gl::is_software() ? "software" : "laptop"));
}

// Returns the budget of a frame. By default it is the display's pace, or 20 frames a second on a
// software renderer. On virtual time frames take no time.
double Viewer::frame_budget_ms() {
  if (o_.frame_ms >= 0) return o_.frame_ms;
  if (o_.virtual_time) return 0;
  if (gl::is_software()) return kSoftwareFrameMs;
  return surface_.window() ? surface_.window()->refresh_ms() : 0;
}

void Viewer::receive(std::int64_t now) {
  log_.recorder().begin();
  const double uploaded_ms = client_.upload_ms();
  if (Result<void> received = client_.update(now); !received) {
    spdlog::warn("{}", received.error().line());
  }
  log_.recorder().lap(FrameStage::kReceive, client_.upload_ms() - uploaded_ms);
  log_.note_arrivals(*host_);
}

void Viewer::draw(FrameStep step) {
  client_.draw();
  if (step == FrameStep::kRefine) {
    const PlannedFrame& planned = client_.planned();
    if (o_.device_model) model_ms_ = o_.device_model->ms_of(work_of(planned, planned.camera, 1));
    log_.recorder().lap(FrameStage::kDraw);
  }
  priced_ = false;
  if (step != FrameStep::kDraw) return;
  const std::uint64_t compiled = client_.compiled();
  if (compiled == 0) log_.recorder().lap(FrameStage::kDraw);
  glFinish();
  log_.recorder().lap(compiled > 0 ? FrameStage::kCompile : FrameStage::kFinish);
  log_.note_compiled(compiled);
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
  log_.stats().note_price(client_.prices()->model().ms_of(client_.drawn_work()), ms);
  client_.done(ms, static_cast<double>(draw_began_us - began_us) * 1e-3);
}

// Returns the time of a frame by the session's clock.
double Viewer::frame_ms(double real_ms, bool drawn) const {
  if (!host_->virtual_clock()) return real_ms;
  if (!o_.device_model) return 1000.0 / o_.fps;
  return drawn ? model_ms_ : 0;
}

Result<void> Viewer::one_frame(std::int64_t frame) {
  const std::int64_t began = real_clock_.now_us();
  const std::int64_t now = host_->now_us();
  receive(now);
  if (Result<void> resized = surface_.fit(client_); !resized) return resized;
  course_.light(session(), now);
  const Pose pose = course_.next(*host_, surface_.window(), now, smooth_ms_ * 1e-3);
  const Result<FrameStep> step = client_.plan(camera_at(pose), now);
  if (!step) return step.error();
  log_.recorder().lap(FrameStage::kPlan);
  const bool drawn = *step != FrameStep::kKeep;
  frame_kept_ = !drawn;
  resting_ = !drawn && session().at_rest();
  const std::int64_t draw_began_us = real_clock_.now_us();
  draw(*step);
  std::int64_t shown_us = real_clock_.now_us();
  if (surface_.window() && (surface_.window()->take_refresh() || drawn)) {
    const Result<std::int64_t> shown = surface_.show(client_, *host_, smooth_ms_, real_clock_);
    if (!shown) return shown.error();
    shown_us = *shown;
  }
  glFinish();
  price(began, draw_began_us, shown_us);
  log_.recorder().lap(FrameStage::kShow);
  session().note_drawn(host_->now_us());
  const double real_ms = static_cast<double>(real_clock_.now_us() - began) / 1000.0;
  const double session_ms = frame_ms(real_ms, drawn);
  log_.note_frame(*host_, client_, drawn, {now, session_ms, real_ms});
  if (drawn) smooth_ms_ += 0.1 * (session_ms - smooth_ms_);
  if (Result<void> written = log_.write_picture(client_, frame); !written) return written;
  const bool compares = o_.reference_every > 0 && frame > 0 && frame % o_.reference_every == 0;
  return compares ? log_.compare(*host_, client_) : Result<void>{};
}

// A window at rest sleeps until somebody touches it or something arrives. A path, a light that
// moves by itself and a modelled link need the clock.
bool Viewer::next_events() {
  Window& window = *surface_.window();
  if (resting_ && course_.rests() && !host_->modelled()) return window.wait(kRestS);
  return frame_kept_ ? window.wait(kKeptFrameS) : window.poll();
}

void Viewer::pace(std::int64_t frame) {
  const std::int64_t due = start_us_ + frame_us(frame + 1);
  if (VirtualClock* clock = host_->virtual_clock()) {
    clock->advance_to_us(due);
    return;
  }
  const std::int64_t left = due - host_->now_us();
  if (o_.offscreen && left > 0) std::this_thread::sleep_for(std::chrono::microseconds(left));
}

bool Viewer::over(std::int64_t frame) const {
  const double seconds = static_cast<double>(host_->now_us() - start_us_) * 1e-6;
  return stop_.stopped() || (o_.length.frames > 0 && frame >= o_.length.frames) ||
         (o_.length.seconds > 0 && seconds >= o_.length.seconds);
}

Result<void> Viewer::frame_loop() {
  start_us_ = host_->now_us();
  course_.start(start_us_);
  log_.start(start_us_);
  stop_.begin_frames();
  for (std::int64_t frame = 0; !over(frame); ++frame) {
    if (surface_.window() && !next_events()) break;
    if (Result<void> done = one_frame(frame); !done) return done;
    if (o_.offscreen) log_.tell_progress(frame + 1);
    pace(frame);
  }
  return {};
}

Result<void> Viewer::run() {
  if (!o_.out_dir.empty()) {
    std::error_code failed;
    std::filesystem::create_directories(o_.out_dir, failed);
    if (failed) return make_error(ErrorId::kIo, "cannot make directory '" + o_.out_dir + "'");
  }
  // Shaders are made first, because a server waits for a limited time for the hello of a client.
  if (Result<void> graphics = open_graphics(); !graphics) return graphics;
  host_ = std::make_unique<ClientHost>(host_options(), client_);
  if (Result<void> link = host_->open(); !link) return link;
  if (const std::optional<Pose> start = CameraPath::start_of(o_.path)) session().start_at(*start);
  price_frames();
  if (Result<void> told = host_->wait_for_picture(); !told) return told;
  if (Result<void> met = course_.meet(session().scene()); !met) return met;
  if (Result<void> looped = frame_loop(); !looped) return looped;
  return log_.finish(*host_, client_);
}

}  // namespace

Result<void> run_viewer(const ViewOptions& options) {
  // A window that sleeps wakes up. Without one there is nothing to wake.
  const StopSignal stop(options.offscreen ? std::function<void()>() : &Window::wake);
  Viewer viewer(options, stop);
  return viewer.run();
}

}  // namespace mirage

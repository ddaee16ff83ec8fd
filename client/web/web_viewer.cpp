#include "client/web/web_viewer.h"

#include <emscripten.h>
#include <emscripten/html5.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/draw/frame_renderer.h"
#include "client/frame/planned_frame.h"
#include "client/hold/tile_cache.h"
#include "client/plan/frame_plan.h"
#include "client/price/cost_fit.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/screen/viewer_defaults.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "protocol/base/quantile.h"
#include "protocol/base/stable_math.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/program.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

constexpr std::size_t kMostUnpriced = 16;  // frames whose time is not known yet
// Prices rest after this many frames from one pose; if they went on changing, a page at rest would
// draw for ever.
constexpr int kMostOfOnePose = 20;
constexpr int kPacedFrames = 4;
constexpr int kProbeFrames = 2;
constexpr double kMostScaled = 8;  // limit of the probe, which draws only part of what frames have
// Intervals up to this many display periods are the display's.
constexpr double kSameDisplay = 1.25;

double budget_ms(const WebOptions& o) {
  if (o.frame_ms >= 0) return o.frame_ms;
  return gl::is_software() ? kSoftwareFrameMs : o.display_ms;
}

ClientOptions session_options(const WebOptions& o) {
  ClientOptions s;
  s.name = "mirage-web";
  s.frame_ms = budget_ms(o);
  s.token = o.token;
  s.choice = o.choice;
  s.mesh_budget_bytes = std::size_t{static_cast<unsigned>(o.mesh_mb)} << 20;
  s.screen.fov_y = WebViewer::kFovY;
  s.screen.width = static_cast<std::uint32_t>(o.width);
  s.screen.height = static_cast<std::uint32_t>(o.height);
  return s;
}

constexpr double kRadians = 0.017453292519943295;  // of a degree

}  // namespace

WebViewer::WebViewer(const WebOptions& options, std::function<void(const Bytes&)> write)
    : options_(options), link_(std::move(write)) {}

WebViewer::~WebViewer() = default;

Result<std::unique_ptr<WebViewer>> WebViewer::create(const WebOptions& options,
                                                     std::function<void(const Bytes&)> write) {
  std::unique_ptr<WebViewer> out(new WebViewer(options, std::move(write)));
  ClientGraphics graphics;
  graphics.width = options.width;
  graphics.height = options.height;
  graphics.atlas_edge = kAtlasEdge;
  graphics.atlas_layers = atlas_layers(options.atlas_mb);
  if (Result<void> made = out->client_.attach(graphics); !made) return made.error();
  Result<Presenter> presenter = Presenter::create();
  if (!presenter) return presenter.error();
  out->presenter_ = presenter.take();
  Result<Insight> insight = Insight::create();
  if (!insight) return insight.error();
  out->insight_ = insight.take();
  WebViewer* const self = out.get();
  out->client_.set_prices(*device_model(gl::is_software() ? "software" : "laptop"));
  out->client_.open(out->link_, session_options(options),
                    [self](const Error& error) { self->problem_ = error.text; });
  out->programs_ = gl::programs_compiled();
  return out;
}

Camera WebViewer::camera() const { return client_.camera(pose_, fov_y_); }

Result<WebViewer::Frame> WebViewer::frame(std::int64_t now_us, int width, int height) {
  const double began = emscripten_get_now(), uploaded = client_.upload_ms();
  Result<void> received = client_.update(now_us);
  upload_ms_ = client_.upload_ms() - uploaded;
  decode_ms_ = emscripten_get_now() - began - upload_ms_;
  if (!received) problem_ = received.error().text;
  if (!met_ && home_known()) {
    pilot_.meet(session().scene());
    met_ = true;
  }
  if (!posed_ && home_known()) go_home();
  if (pilot_.needs_ground()) session().want_ground(pose_.eye, now_us);
  if (Result<void> sized = client_.resize(width, height); !sized) return sized.error();
  const Result<FrameStep> step = client_.plan(camera(), now_us);
  if (!step) return step.error();
  Frame out;
  out.drawn = *step != FrameStep::kKeep;
  out.resting = !out.drawn && session().at_rest();
  out.drawable = session().drawable();
  client_.draw();
  if (*step == FrameStep::kDraw) note_work();
  if (out.drawn || layer_ != InsightLayer::kNone) {
    const FrameTarget& shown = client_.screen().shown();
    fit_canvas(shown.drawn_width(), shown.drawn_height());
    presenter_.show_as_drawn(shown);
    Result<void> tinted =
        insight_.draw(layer_, client_.renderer(), shown.drawn_camera(client_.planned().camera),
                      client_.planned(), now_us);
    if (!tinted) return tinted.error();
  }
  if (out.drawn) session().note_drawn(now_us);
  return out;
}

// Sets the canvas's pixels; the page decides how large it is shown.
void WebViewer::fit_canvas(int width, int height) {
  if (width == canvas_width_ && height == canvas_height_) return;
  emscripten_set_canvas_element_size("#mirage", width, height);
  canvas_width_ = width;
  canvas_height_ = height;
}

void WebViewer::note_work() {
  // A compilation, also one while taking in what has arrived, happens only once.
  const bool compiled = gl::programs_compiled() != programs_;
  programs_ = gl::programs_compiled();
  ++drawn_frames_;
  const bool same = pose_.eye == priced_pose_.eye && pose_.rotation == priced_pose_.rotation;
  seen_from_it_ = same ? seen_from_it_ + 1 : 0;
  priced_pose_ = pose_;
  drawn_.push_back({drawn_frames_, client_.drawn_work(), compiled});
  if (drawn_.size() > kMostUnpriced) drawn_.pop_front();
}

bool WebViewer::prices_rest() const { return seen_from_it_ > kMostOfOnePose; }

void WebViewer::note_gpu_ms(std::uint64_t frame, double ms) {
  timed_ = true;
  if (prices_rest()) return;
  for (const Drawn& drawn : drawn_) {
    if (drawn.frame != frame || drawn.compiled) continue;
    client_.learn(drawn.work, ms);
  }
}

// Frames are given to the graphics card ahead of time, so one interval belongs to another frame, or
// to several. Only a few intervals together belong to their frames. Within the display's pace they
// say that frames took no longer. Beyond it they say that frames took all of it, because the next
// one was already waiting.
void WebViewer::note_interval_ms(double ms) {
  const bool compiles =
      std::any_of(drawn_.begin(), drawn_.end(), [](const Drawn& drawn) { return drawn.compiled; });
  if (drawn_.empty() || compiles || prices_rest()) {
    paced_ = {};
    return;
  }
  // The display shows a picture at its next refresh after it is ready, half a period later on
  // average.
  session().note_frame_ms(ms - 0.5 * options_.display_ms);
  paced_.work += drawn_.back().work;
  paced_.ms += ms;
  if (++paced_.frames < kPacedFrames) return;
  FrameWork work = paced_.work;
  for (double& amount : work.amount) amount /= kPacedFrames;
  const double mean = paced_.ms / kPacedFrames;
  paced_ = {};
  const bool in_pace = mean <= kSameDisplay * options_.display_ms;
  // The graphics card's own clock is more exact.
  if (timed_ || (in_pace && prices().ms_of(work) <= mean)) return;
  client_.learn(work, mean);
}

const CostModel& WebViewer::prices() const { return client_.prices()->model(); }

void WebViewer::probe() {
  PlannedFrame nothing;
  nothing.camera = camera();
  nothing.scene = &session().scene();
  nothing.lighting = session().lighting();
  const auto draw = [&] {
    client_.screen().draw(client_.renderer(), nothing);
    client_.screen().shown().read();  // only reading waits for the graphics card here
  };
  draw();  // programs are finished at their first use
  const double began = emscripten_get_now();
  for (int i = 0; i < kProbeFrames; ++i) draw();
  const double ms = (emscripten_get_now() - began) / kProbeFrames;
  const double expected = prices().ms_of(client_.screen().work(nothing));
  if (!(ms > 0) || !(expected > 0)) return;
  CostModel prices = this->prices();
  for (double& price : prices.ms) price *= std::clamp(ms / expected, 1 / kMostScaled, kMostScaled);
  client_.set_prices(prices);
  client_.screen().content_changed();
}

void WebViewer::steer(const Steering& by) {
  if (by.moves()) pilot_.look_ahead(session().scene(), camera());
  pilot_.steer(by, camera().fov_y, session().ground(), pose_);
}

bool WebViewer::aim(const glm::dvec2& place) {
  const std::optional<Seen> seen = seen_at(session().scene(), camera(), place);
  if (seen) pilot_.aim(seen->point);
  return seen.has_value();
}

std::string WebViewer::name_at(const glm::dvec2& place) const {
  const SceneView& scene = session().scene();
  const std::optional<Seen> seen = seen_at(scene, camera(), place);
  return seen ? scene.objects[scene.instances[seen->instance].object].name : "";
}

void WebViewer::set_pose(const Pose& pose) {
  pose_ = pose;
  posed_ = true;
  if (!home_known()) session().start_at(pose);  // the first picture is of the place of the link
}

void WebViewer::go_home() {
  const HomeView& home = session().scene().home;
  pose_ = home_pose(home, camera());
  pilot_.aim(home.target);
  posed_ = true;
}

void WebViewer::choose(SceneChoice choice) { session().choose(std::move(choice)); }
void WebViewer::play(bool playing, std::int64_t now_us) { session().play(playing, now_us); }
bool WebViewer::home_known() const { return session().scene().welcomed(); }
bool WebViewer::has_ground() const { return session().scene().home.walk_eye_m > 0; }

void WebViewer::set_pace(double share) { session().set_frame_ms(share * budget_ms(options_)); }

std::optional<std::array<double, 2>> WebViewer::own_sun() const {
  for (const Light& one : session().scene().lighting.lights) {
    if (one.kind != LightKind::kDirectional) continue;
    const glm::dvec3 to_sun = -glm::dvec3(one.direction);
    return std::array<double, 2>{std::atan2(to_sun.x, -to_sun.z) / kRadians,
                                 std::asin(glm::clamp(to_sun.y, -1.0, 1.0)) / kRadians};
  }
  return std::nullopt;
}

void WebViewer::set_sun(std::optional<std::array<double, 2>> at, std::int64_t now_us) {
  Lighting light = session().scene().lighting;
  if (at) {
    const double azimuth = (*at)[0] * kRadians, elevation = (*at)[1] * kRadians;
    const glm::dvec3 to_sun(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                            -std::cos(azimuth) * std::cos(elevation));
    for (Light& one : light.lights) {
      if (one.kind == LightKind::kDirectional) one.direction = glm::vec3(-to_sun);
    }
  }
  session().set_lighting(light, now_us);
}

void WebViewer::set_background(const std::optional<glm::vec3>& color) {
  client_.renderer().set_background(color);
  client_.screen().content_changed();
}

void WebViewer::show_layer(InsightLayer layer) {
  layer_ = layer;
  client_.screen().content_changed();
}

std::vector<std::uint8_t> WebViewer::pixels() const { return client_.screen().shown().read(); }
int WebViewer::width() const { return client_.screen().width(); }
int WebViewer::height() const { return client_.screen().height(); }

std::string WebViewer::renderer() const { return gl::renderer_name(); }

void WebViewer::ask_reference(std::uint32_t supersample) {
  session().ask_reference(camera(), supersample);
}

std::string WebViewer::figures(std::int64_t now_us) const {
  double bound = 0;
  std::size_t relit = 0;
  std::vector<float> ages_ms;
  for (const DrawnImpostor& drawn : client_.planned().list.impostors) {
    relit += drawn.tile->relit ? 1 : 0;
    if (std::isfinite(drawn.bound_px)) bound = std::max(bound, drawn.bound_px);
    ages_ms.push_back(static_cast<float>(now_us - drawn.tile->received_us) / 1000.0f);
  }
  const FramePlan& plan = session().plan();
  const LinkTraffic traffic = link_.traffic();
  const GpuBytes gpu = client_.renderer().gpu_bytes();
  const TileCounts tiles = session().tiles();
  char text[1536];
  std::snprintf(
      text, sizeof(text),
      "{\"complete\":%s,\"atRest\":%s,\"refined\":%s,\"awaitsNewScene\":%s,\"references\":%s,"
      "\"geometry\":%s,"
      "\"budgetMs\":%g,\"plannedMs\":%g,\"mostMs\":%g,\"lambda\":%g,\"scale\":%g,\"samples\":%d,"
      "\"drawCalls\":%d,"
      "\"impostors\":%zu,\"relit\":%zu,\"meshes\":%zu,\"placeholders\":%zu,\"view\":%s,\"boundPx\":"
      "%g,\"expectedFlip\":%g,"
      "\"tauPx\":%g,\"overTau\":%zu,\"visible\":%zu,\"tileAgeS\":%g,\"bytesDown\":%llu,"
      "\"bytesUp\":%llu,\"roundTripMs\":%lld,\"inFlight\":%zu,\"tilesAsked\":%llu,"
      "\"tilesReceived\":%llu,"
      "\"codec\":\"%s\",\"gpuBytes\":%zu,\"targetBytes\":%zu,\"drawnFrames\":%llu,"
      "\"software\":%s}",
      session().scene().complete() ? "true" : "false", session().at_rest() ? "true" : "false",
      client_.screen().refined() ? "true" : "false",
      session().awaits_new_scene() ? "true" : "false",
      session().scene().reference ? "true" : "false", session().scene().geometry ? "true" : "false",
      plan.limited() ? plan.budget_ms() : 0.0, plan.expected_ms(),
      plan.limited() ? plan.planned_ms() : 0.0, plan.lambda(), plan.setting().scale,
      plan.setting().samples, client_.renderer().draw_calls(),
      client_.planned().list.impostors.size(), relit, client_.planned().list.meshes.size(),
      client_.planned().list.placeholders.size(), client_.planned().list.view ? "true" : "false",
      bound, plan.expected_flip(), session().tau_px(), client_.planned().list.over_tau,
      client_.planned().list.visible, static_cast<double>(quantile(ages_ms, 0.5)) / 1000,
      static_cast<unsigned long long>(traffic.bytes_down),
      static_cast<unsigned long long>(traffic.bytes_up),
      static_cast<long long>(session().round_trip_us() / 1000), session().in_flight(),
      static_cast<unsigned long long>(tiles.asked), static_cast<unsigned long long>(tiles.received),
      codec_name(session().codec()), gpu.all(), client_.screen().gpu_bytes(),
      static_cast<unsigned long long>(drawn_frames_), gl::is_software() ? "true" : "false");
  return text;
}

}  // namespace mirage

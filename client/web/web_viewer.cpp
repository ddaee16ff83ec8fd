#include "client/web/web_viewer.h"

#include <emscripten.h>
#include <emscripten/html5.h>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/plan/frame_plan.h"
#include "client/price/cost_fit.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/screen/viewer_defaults.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "client/web/web_figures.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

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

}  // namespace

WebViewer::WebViewer(const WebOptions& options, std::function<void(const Bytes&)> write)
    : options_(options), link_(std::move(write)), prices_(client_, options.display_ms) {}

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
  out->prices_.begin();
  return out;
}

Camera WebViewer::camera() const { return client_.camera(eye_.pose(), fov_y_); }

Result<WebViewer::Frame> WebViewer::frame(std::int64_t now_us, int width, int height) {
  const double began = emscripten_get_now(), uploaded = client_.upload_ms();
  Result<void> received = client_.update(now_us);
  upload_ms_ = client_.upload_ms() - uploaded;
  decode_ms_ = emscripten_get_now() - began - upload_ms_;
  if (!received) problem_ = received.error().text;
  eye_.prepare(session(), camera(), now_us);
  if (Result<void> sized = client_.resize(width, height); !sized) return sized.error();
  const Result<FrameStep> step = client_.plan(camera(), now_us);
  if (!step) return step.error();
  Frame out;
  out.drawn = *step != FrameStep::kKeep;
  out.resting = !out.drawn && session().at_rest();
  out.drawable = session().drawable();
  client_.draw();
  if (*step == FrameStep::kDraw) prices_.note_drawn(eye_.pose());
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

const CostModel& WebViewer::prices() const { return client_.prices()->model(); }

void WebViewer::steer(const Steering& by) { eye_.steer(by, session(), camera()); }
bool WebViewer::aim(const glm::dvec2& place) { return eye_.aim(session(), camera(), place); }
void WebViewer::set_pose(const Pose& pose) { eye_.set_pose(session(), pose); }
void WebViewer::go_home() { eye_.go_home(session(), camera()); }

std::string WebViewer::name_at(const glm::dvec2& place) const {
  const std::optional<std::uint32_t> object = mirage::object_at(session(), camera(), place);
  return object ? session().scene().objects[*object].name : "";
}

std::optional<std::uint32_t> WebViewer::object_at(const glm::dvec2& place) const {
  const std::optional<std::uint32_t> object = mirage::object_at(session(), camera(), place);
  if (!object || session().scene().objects[*object].group) return std::nullopt;
  return object;
}

void WebViewer::choose(SceneChoice choice) { session().choose(std::move(choice)); }
void WebViewer::play(bool playing, std::int64_t now_us) { session().play(playing, now_us); }
bool WebViewer::home_known() const { return session().scene().welcomed(); }
bool WebViewer::has_ground() const { return session().scene().home.walk_eye_m > 0; }

void WebViewer::set_pace(double share) { session().set_frame_ms(share * budget_ms(options_)); }

std::optional<SunPlace> WebViewer::own_sun() const { return sun_place(session().scene().lighting); }

void WebViewer::set_sun(const std::optional<SunPlace>& at, std::int64_t now_us) {
  Lighting light = session().scene().lighting;
  if (at) put_sun(*at, light);
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
Result<std::vector<float>> WebViewer::depths() {
  if (!probe_) {
    Result<DepthProbe> made = DepthProbe::create();
    if (!made) return made.error();
    probe_.emplace(made.take());
  }
  const FrameTarget& shown = client_.screen().shown();
  const GLuint texture = shown.depth_texture();
  if (texture == 0) return make_error(ErrorId::kGraphicsGl, "no memory for a depth texture");
  const int drawn_width = shown.drawn_width(), drawn_height = shown.drawn_height();
  const std::vector<float> windows = probe_->read(texture, 0, 0, drawn_width, drawn_height);
  const glm::dvec2 mapping = client_.planned().camera.window_depth(
      gl::has_clip_control() ? DepthMapping::kReversed : DepthMapping::kForward);
  const double nothing = mapping.y > 0 ? 0 : 1;  // reversed or forward
  const int w = width(), h = height();
  std::vector<float> out;
  out.reserve(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  for (int y = 0; y < h; ++y) {
    const int row = drawn_height - 1 - y * drawn_height / h;  // read from the bottom
    for (int x = 0; x < w; ++x) {
      const auto at = static_cast<std::size_t>(row * drawn_width + x * drawn_width / w);
      const double window = windows[at];
      out.push_back(window == nothing ? 0 : static_cast<float>(mapping.y / (window - mapping.x)));
    }
  }
  return out;
}

int WebViewer::width() const { return client_.screen().width(); }
int WebViewer::height() const { return client_.screen().height(); }

std::string WebViewer::renderer() const { return gl::renderer_name(); }

void WebViewer::ask_reference(std::uint32_t supersample) {
  session().ask_reference(camera(), supersample);
}

std::string WebViewer::figures(std::int64_t now_us) const {
  return web_figures(client_, link_.traffic(), prices_.drawn_frames(), now_us);
}

}  // namespace mirage

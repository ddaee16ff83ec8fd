#include "client/door/client.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "client/door/renderer_sink.h"
#include "client/draw/frame_renderer.h"
#include "client/frame/planned_frame.h"
#include "client/price/cost_fit.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "protocol/base/clock.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {
namespace {

/// Takes what a client without graphics is sent.
TileSink no_sink() {
  TileSink sink;
  sink.tile = [](const TileRecord&, const AtlasPlanes&) {};
  sink.shadow = [](const ShadowRecord&, const std::vector<std::uint8_t>&) {};
  sink.mesh = [](std::uint32_t, std::uint8_t, const ObjectModel&) {};
  sink.image = [](std::uint32_t, const Image&, const std::vector<Image>&) {};
  sink.drop = [](const AssetId&) {};
  sink.scene = [](const SceneView&) {};
  sink.view = [](const ViewTile&) {};
  return sink;
}

}  // namespace

namespace {

/// A view of the frame, from frame to frame.
struct View {
  Screen screen;
  PlannedFrame planned;
  FrameStep step = FrameStep::kKeep;
};

}  // namespace

struct Client::Parts {
  ClientGraphics graphics;
  std::optional<FrameRenderer> renderer;
  std::vector<View> views = std::vector<View>(1);
  std::unique_ptr<ClientSession> session;
  bool draws = false;          ///< some view of the planned frame has got a new picture
  FrameWork work;              ///< of the last frame that drew
  std::uint64_t compiled = 0;  ///< programs for it
  std::optional<CostFit> prices;
  double upload_ms = 0;

  void forget_plans() {
    views.resize(1);
    views[0].planned = {};
    views[0].step = FrameStep::kKeep;
  }
  void content_changed() {
    for (View& view : views) view.screen.content_changed();
  }
};

Client::Client() : parts_(std::make_unique<Parts>()) {}
Client::~Client() = default;

Result<void> Client::attach(const ClientGraphics& graphics) {
  Parts& p = *parts_;
  Result<FrameRenderer> renderer =
      FrameRenderer::create(graphics.atlas_edge, graphics.atlas_layers, graphics.flat);
  if (!renderer) return renderer.error();
  p.renderer.emplace(renderer.take());
  p.graphics = graphics;
  return p.views[0].screen.create(graphics.width, graphics.height);
}

void Client::detach(bool context_lost) {
  Parts& p = *parts_;
  close();
  std::optional<gl::ForgetNames> forget;
  if (context_lost) forget.emplace();
  p.renderer.reset();
  p.views[0].screen = Screen();
}

void Client::open(Link& link, ClientOptions options, std::function<void(const Error&)> problem) {
  Parts& p = *parts_;
  close();
  TileSink sink = no_sink();
  if (p.renderer) {
    options.atlas_edge = p.graphics.atlas_edge;
    options.atlas_layers = p.graphics.atlas_layers;
    SinkHooks hooks;
    hooks.scene = [&p]() -> const SceneView& { return p.session->scene(); };
    hooks.changed = [&p] { p.content_changed(); };
    hooks.failed = problem ? std::move(problem) : [](const Error&) {};
    const auto now_ms = [clock = SteadyClock()] {
      return static_cast<double>(clock.now_us()) * 1e-3;
    };
    sink = timed(renderer_sink(*p.renderer, std::move(hooks)), now_ms, p.upload_ms);
    p.content_changed();
  }
  p.session = std::make_unique<ClientSession>(link, std::move(options), std::move(sink));
  if (p.prices) p.session->set_prices(p.prices->model());
}

void Client::close() {
  parts_->session.reset();
  parts_->forget_plans();
}

ClientSession& Client::session() { return *parts_->session; }
const ClientSession& Client::session() const { return *parts_->session; }
FrameRenderer& Client::renderer() { return *parts_->renderer; }
const FrameRenderer& Client::renderer() const { return *parts_->renderer; }
Screen& Client::screen(std::size_t view) { return parts_->views[view].screen; }
const Screen& Client::screen(std::size_t view) const { return parts_->views[view].screen; }

Result<void> Client::update(std::int64_t now_us) { return parts_->session->receive(now_us); }

double Client::upload_ms() const { return parts_->upload_ms; }

Result<void> Client::resize(int width, int height) {
  return parts_->views[0].screen.fit(width, height, *parts_->session);
}

Camera Client::camera(const Pose& pose, double fov_y) const {
  const Parts& p = *parts_;
  Camera camera;
  camera.pose = pose;
  camera.fov_y = fov_y;
  camera.width = static_cast<std::uint32_t>(p.views[0].screen.width());
  camera.height = static_cast<std::uint32_t>(p.views[0].screen.height());
  const SceneView& scene = p.session->scene();
  camera.fit_depth_range(scene.bounds_center, scene.bounds_radius);
  return camera;
}

Result<FrameStep> Client::plan(const std::vector<Camera>& views, std::int64_t now_us) {
  Parts& p = *parts_;
  std::vector<PlannedFrame> planned = p.session->frame(views, now_us);
  p.views.resize(planned.size());
  p.draws = false;
  FrameStep out = FrameStep::kKeep;
  for (std::size_t i = 0; i < planned.size(); ++i) {
    View& view = p.views[i];
    view.planned = std::move(planned[i]);
    // The target gets the samples and the scale that were planned with this frame.
    const int width = static_cast<int>(views[i].width), height = static_cast<int>(views[i].height);
    if (!view.screen.created()) {
      if (Result<void> made = view.screen.create(width, height); !made) return made.error();
    }
    const Result<void> fitted = view.screen.fit(width, height, *p.session);
    if (!fitted) return fitted.error();
    view.step = view.screen.next(view.planned, *p.session);
    out = std::max(out, view.step);
  }
  return out;
}

Result<FrameStep> Client::plan(const Camera& camera, std::int64_t now_us) {
  return plan(std::vector<Camera>{camera}, now_us);
}

const PlannedFrame& Client::planned(std::size_t view) const { return parts_->views[view].planned; }

void Client::draw(std::size_t index) {
  Parts& p = *parts_;
  View& view = p.views[index];
  const FrameStep step = std::exchange(view.step, FrameStep::kKeep);
  if (step == FrameStep::kRefine) view.screen.refine(*p.renderer, view.planned);
  if (step != FrameStep::kDraw) return;
  if (!std::exchange(p.draws, true)) {
    p.work = {};
    p.compiled = 0;
  }
  const std::uint64_t programs = gl::programs_compiled();
  view.screen.draw(*p.renderer, view.planned);
  p.compiled += gl::programs_compiled() - programs;
  p.work += view.screen.work(view.planned);
}

std::size_t Client::gpu_bytes() const {
  std::size_t bytes = parts_->renderer->gpu_bytes().all();
  for (const View& view : parts_->views) bytes += view.screen.gpu_bytes();
  return bytes;
}

const FrameWork& Client::drawn_work() const { return parts_->work; }
std::uint64_t Client::compiled() const { return parts_->compiled; }

void Client::set_prices(const CostModel& prices) {
  parts_->prices.emplace(prices);
  if (parts_->session) parts_->session->set_prices(prices);
}

const CostFit* Client::prices() const { return parts_->prices ? &*parts_->prices : nullptr; }

void Client::learn(const FrameWork& work, double ms) {
  Parts& p = *parts_;
  if (!p.prices) return;
  p.prices->add(work, ms);
  p.session->set_prices(p.prices->model());
}

void Client::done(double ms, double beside_ms) {
  Parts& p = *parts_;
  p.session->note_frame_ms(ms, beside_ms);
  if (p.compiled == 0) learn(p.work, ms);  // a compilation happens only once, so it is no price
}

}  // namespace mirage

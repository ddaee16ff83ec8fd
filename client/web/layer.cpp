#include "client/web/layer.h"

#include <algorithm>
#include <utility>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/price/cost_model.h"
#include "client/screen/screen.h"
#include "client/screen/viewer_defaults.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "client/web/web_figures.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

constexpr double kHardwareFrameMs = 16;
constexpr GLuint kTextureUnits = 16;  // those that every WebGL 2 has
// Values of WebGL alone (WebGL 1.0, 5.14.8).
constexpr GLenum kUnpackFlipY = 0x9240, kUnpackPremultiply = 0x9241;

ClientOptions session_options(const LayerOptions& o) {
  ClientOptions s;
  s.name = "mirage-layer";
  s.frame_ms = o.frame_ms > 0      ? o.frame_ms
               : gl::is_software() ? kSoftwareFrameMs
                                   : kHardwareFrameMs;
  s.tau_px = o.tau_px;
  if (o.samples > 0) s.samples = o.samples;
  s.token = o.token;
  s.choice = o.choice;
  s.mesh_budget_bytes = std::size_t{static_cast<unsigned>(o.mesh_mb)} << 20;
  return s;
}

/// Sets what a host may have changed, or Mirage has, to GL's initial values. It asks for nothing:
/// that would wait for the graphics card.
void set_initial_values() {
  for (const GLenum name : {GL_BLEND, GL_CULL_FACE, GL_DEPTH_TEST, GL_SCISSOR_TEST, GL_STENCIL_TEST,
                            GL_POLYGON_OFFSET_FILL, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_COVERAGE,
                            GL_RASTERIZER_DISCARD}) {
    glDisable(name);
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  glDepthRangef(0, 1);
  glClearColor(0, 0, 0, 0);
  glClearDepthf(1);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ZERO);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  if (gl::has_clip_control()) gl::set_clip_depth_zero_to_one(false);
  const std::pair<GLenum, GLint> stored[] = {
      {GL_UNPACK_ALIGNMENT, 4},   {GL_UNPACK_ROW_LENGTH, 0},   {GL_UNPACK_SKIP_ROWS, 0},
      {GL_UNPACK_SKIP_PIXELS, 0}, {GL_UNPACK_IMAGE_HEIGHT, 0}, {GL_UNPACK_SKIP_IMAGES, 0},
      {kUnpackFlipY, 0},          {kUnpackPremultiply, 0},     {GL_PACK_ALIGNMENT, 4}};
  for (const auto& [name, value] : stored) glPixelStorei(name, value);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  for (GLuint unit = 0; unit < kTextureUnits; ++unit) glBindSampler(unit, 0);
  glUseProgram(0);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace

Layer::Layer(LayerOptions options, std::function<void(const Bytes&)> write)
    : options_(std::move(options)), link_(std::move(write)) {}

Layer::~Layer() = default;

Result<void> Layer::attach() {
  set_initial_values();
  ClientGraphics graphics;
  graphics.atlas_edge = kAtlasEdge;
  graphics.atlas_layers = atlas_layers(options_.atlas_mb);
  if (Result<void> made = client_.attach(graphics); !made) return made.error();
  Result<Presenter> presenter = Presenter::create();
  if (!presenter) return presenter.error();
  presenter_ = presenter.take();
  Result<DepthProbe> probe = DepthProbe::create();
  if (!probe) return probe.error();
  probe_ = probe.take();
  client_.renderer().show_background(options_.sky);
  client_.set_prices(*device_model(gl::is_software() ? "software" : "laptop"));
  client_.open(link_, session_options(options_),
               [this](const Error& error) { problem_ = error.text; });
  attached_ = true;
  set_initial_values();
  return {};
}

void Layer::detach(bool context_lost) {
  attached_ = false;
  pictures_.clear();
  std::optional<gl::ForgetNames> forget;
  if (context_lost) forget.emplace();
  presenter_ = Presenter();
  probe_ = DepthProbe();
  client_.detach(context_lost);
}

Result<Layer::Frame> Layer::frame(std::int64_t now_us, const std::vector<Camera>& views) {
  set_initial_values();
  if (Result<void> received = client_.update(now_us); !received) problem_ = received.error().text;
  Frame out;
  out.drawable = session().drawable();
  if (!out.drawable || views.empty()) {
    pictures_.clear();
    set_initial_values();
    return out;
  }
  const Result<FrameStep> step = client_.plan(views, now_us);
  if (!step) return step.error();
  out.drawn = *step != FrameStep::kKeep;
  out.resting = !out.drawn && session().at_rest();
  for (std::size_t view = 0; view < views.size(); ++view) client_.draw(view);
  if (out.drawn || pictures_.size() != views.size()) {
    pictures_.resize(views.size());
    if (Result<void> taken = take_pictures(); !taken) return taken.error();
  }
  if (out.drawn) {
    ++drawn_frames_;
    session().note_drawn(now_us);
  }
  set_initial_values();
  return out;
}

Result<void> Layer::take_pictures() {
  const DepthMapping mapping =
      gl::has_clip_control() ? DepthMapping::kReversed : DepthMapping::kForward;
  for (std::size_t view = 0; view < pictures_.size(); ++view) {
    const FrameTarget& shown = client_.screen(view).shown();
    LayerPicture& picture = pictures_[view];
    picture.color = shown.resolved_texture();
    picture.depth = shown.depth_texture();
    picture.width = shown.drawn_width();
    picture.height = shown.drawn_height();
    picture.window_depth = client_.planned(view).camera.window_depth(mapping);
    if (picture.depth == 0) {
      return make_error(ErrorId::kGraphicsGl, "no memory for a depth texture");
    }
  }
  return {};
}

void Layer::present() {
  if (pictures_.empty()) return;
  presenter_.show_as_drawn(client_.screen().shown());
  set_initial_values();
}

std::optional<glm::dvec3> Layer::point_at(std::size_t view, const glm::dvec2& place) {
  const bool inside = place.x >= 0 && place.y >= 0 && place.x < 1 && place.y < 1;
  if (view >= pictures_.size() || !inside) return std::nullopt;
  const LayerPicture& picture = pictures_[view];
  const glm::dvec2 texels(picture.width, picture.height);
  const glm::dvec2 at(place.x * texels.x, (1 - place.y) * texels.y);
  set_initial_values();
  const double window = probe_.read(picture.depth, static_cast<int>(at.x),
                                    std::min(static_cast<int>(at.y), picture.height - 1));
  set_initial_values();
  const glm::dvec2 mapping = picture.window_depth;
  const double nothing = mapping.y > 0 ? 0 : 1;  // reversed or forward
  if (window == nothing) return std::nullopt;
  const Camera camera = client_.planned(view).camera.at_size(
      static_cast<std::uint32_t>(picture.width), static_cast<std::uint32_t>(picture.height));
  const glm::dvec2 middle = 0.5 * texels + camera.shift_px;
  const glm::dvec2 tangents = (at - middle) / (0.5 * texels) * camera.half_tangents();
  const double depth = mapping.y / (window - mapping.x);
  return camera.pose.eye +
         depth * (camera.forward() + tangents.x * camera.right() + tangents.y * camera.up());
}

std::string Layer::figures(std::int64_t now_us) const {
  return web_figures(client_, link_.traffic(), drawn_frames_, now_us);
}

}  // namespace mirage

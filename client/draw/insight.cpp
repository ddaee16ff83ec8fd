#include "client/draw/insight.h"

#include <algorithm>
#include <cmath>

#include "client/draw/frame_renderer.h"
#include "client/draw/tints.h"
#include "client/frame/draw_list.h"
#include "client/frame/planned_frame.h"
#include "client/hold/tile_cache.h"
#include "protocol/impostor/camera.h"
#include "shaders/gl/program.h"
#include "shaders/gl/render_target.h"

namespace mirage {
namespace {

constexpr glm::vec4 kFlat{0.35f, 0.65f, 1, 1}, kRelief{0.3f, 0.95f, 0.4f, 1},
    kMesh{1, 0.85f, 0.2f, 1}, kMissing{1, 0.25f, 0.2f, 1};
constexpr float kOpacity = 0.5f;
constexpr double kOldUs = 60e6;

glm::vec4 heat_tint(double share) {
  const std::array<float, 3> color = heat(share);
  return {color[0], color[1], color[2], 1};
}

glm::vec4 tint_of(InsightLayer layer, const DrawnImpostor& drawn, double tau_px,
                  std::int64_t now_us) {
  switch (layer) {
    case InsightLayer::kSources:
      return drawn.method == DrawMethod::kDepth ? kRelief : kFlat;
    case InsightLayer::kBound:
      return heat_tint(0.5 * drawn.bound_px / std::max(tau_px, 1e-6));
    case InsightLayer::kAge:
      return heat_tint(static_cast<double>(now_us - drawn.tile->received_us) / kOldUs);
    default:
      return glm::vec4(0);
  }
}

}  // namespace

struct Insight::Parts {
  gl::Program over;  ///< lays the tints over the picture
  gl::VertexArray vao;
  gl::RenderTarget target;

  Result<void> fit(int width, int height) {
    if (target.ok() && target.width() == width && target.height() == height) return {};
    target = gl::RenderTarget(width, height, {GL_RGBA8}, GL_DEPTH_COMPONENT32F);
    if (target.ok()) return {};
    return make_error(ErrorId::kGraphicsGl, "there is no graphics memory for a picture of tints");
  }
};

Insight::Insight() : parts_(std::make_unique<Parts>()) {}
Insight::Insight(Insight&& other) noexcept = default;
Insight& Insight::operator=(Insight&& other) noexcept = default;
Insight::~Insight() = default;

std::array<float, 3> heat(double share) {
  const auto x = static_cast<float>(std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 1.0);
  return {std::min(1.0f, 2 * x), std::min(1.0f, 2 - 2 * x), 0.1f};
}

Tints tints_of(InsightLayer layer, const DrawList& list, double tau_px, std::int64_t now_us) {
  Tints out;
  for (const DrawnImpostor& drawn : list.impostors) {
    out.impostors.push_back(tint_of(layer, drawn, tau_px, now_us));
  }
  const bool sources = layer == InsightLayer::kSources;
  if (sources || layer == InsightLayer::kGeometry) out.meshes = kMesh;
  if (sources) out.placeholders = kMissing;
  if (layer == InsightLayer::kBound) out.placeholders = heat_tint(1);
  return out;
}

Result<Insight> Insight::create() {
  Insight out;
  Result<gl::Program> over = gl::Program::create("common/fullscreen.vert", "overlay/tint.frag", {});
  if (!over) return over.error();
  out.parts_->over = over.take();
  out.parts_->vao = gl::VertexArray::create();
  return out;
}

Result<void> Insight::draw(InsightLayer layer, FrameRenderer& renderer, const Camera& camera,
                           const PlannedFrame& frame, std::int64_t now_us) {
  if (layer == InsightLayer::kNone) return {};
  Parts& p = *parts_;
  const int width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
  if (Result<void> fitted = p.fit(width, height); !fitted) return fitted;
  p.target.bind();
  glViewport(0, 0, width, height);
  const Tints tints = tints_of(layer, frame.list, frame.tau_px, now_us);
  if (Result<void> drawn = renderer.draw_tints(camera, frame, tints); !drawn) return drawn;
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  p.over.use();
  p.over.set("u_tints", 0);
  p.over.set("u_opacity", kOpacity);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, p.target.color(0));
  glBindVertexArray(p.vao.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  return {};
}

}  // namespace mirage

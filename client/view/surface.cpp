#include "client/view/surface.h"

#include "client/door/client.h"
#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/host/client_host.h"
#include "client/screen/screen.h"
#include "client/view/options.h"
#include "client/view/overlay_text.h"
#include "protocol/base/clock.h"
#include "shaders/gl/dialect.h"

namespace mirage {

Result<void> Surface::open(const ViewOptions& options) {
  if (options.offscreen) {
    const Offscreen& graphics = options.graphics;
    Result<gl::EglContext> egl = gl::EglContext::create(graphics.device, graphics.gles);
    if (!egl) return egl.error();
    egl_ = std::move(*egl);
    return {};
  }
  Result<Window> window = Window::create(options.width, options.height);
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
  return {};
}

Result<void> Surface::fit(Client& client) const {
  int width = client.screen().width(), height = client.screen().height();
  if (window_) window_->framebuffer_size(width, height);
  return client.resize(width, height);
}

Result<std::int64_t> Surface::show(Client& client, const ClientHost& host, double frame_ms,
                                   const Clock& clock) {
  const PlannedFrame& planned = client.planned();
  const Screen& screen = client.screen();
  const std::int64_t now = host.now_us();
  presenter_->show(screen.shown());
  gl::encode_srgb(false);
  Result<void> tinted = insight_->draw(static_cast<InsightLayer>(window_->layer()),
                                       client.renderer(), planned.camera, planned, now);
  gl::encode_srgb(true);
  if (!tinted) return tinted.error();
  if (window_->overlay()) {
    const OverlayFigures figures{frame_ms, client.renderer().draw_calls()};
    overlay_->draw(overlay_text(host, planned.list, figures, now), screen.width(), screen.height());
  }
  glFinish();
  const std::int64_t shown_us = clock.now_us();
  window_->present();
  return shown_us;
}

}  // namespace mirage

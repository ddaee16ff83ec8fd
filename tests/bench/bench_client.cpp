#include "tests/bench/bench_client.h"

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/draw_list.h"
#include "client/session/client_session.h"

namespace mirage::bench {

Result<std::unique_ptr<BenchClient>> BenchClient::create(const HostOptions& host,
                                                         const View& view) {
  auto out = std::unique_ptr<BenchClient>(new BenchClient);
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  if (!egl) return egl.error();
  out->egl_ = std::move(*egl);
  ClientGraphics graphics;
  graphics.atlas_edge = host.session.atlas_edge;
  graphics.atlas_layers = host.session.atlas_layers;
  if (Result<void> made = out->client_.attach(graphics); !made) return made.error();
  Result<FrameTarget> target = FrameTarget::create(view.width, view.height, view.samples);
  if (!target) return target.error();
  out->target_.emplace(target.take());
  out->host_ = std::make_unique<ClientHost>(host, out->client_);
  if (Result<void> opened = out->host_->open(); !opened) return opened.error();
  if (Result<void> met = out->host_->wait_for_scene(); !met) return met.error();
  return out;
}

void BenchClient::draw(const FrameTarget& target, const PlannedFrame& frame) {
  client_.renderer().draw(target, frame);
  glFinish();
}

}  // namespace mirage::bench

#include "client/screen/screen.h"

#include <algorithm>

#include "client/draw/frame_renderer.h"
#include "client/plan/frame_plan.h"
#include "client/price/frame_work.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"

namespace mirage {

Result<void> Screen::make(int width, int height, bool blends, int samples, double scale) {
  Result<FrameTarget> target = FrameTarget::create(width, height, samples, blends, scale);
  if (!target) return target.error();
  target_.emplace(target.take());
  samples_ = samples;
  scale_ = scale;
  return {};
}

Result<void> Screen::create(int width, int height) { return make(width, height, false, 1, 1); }

Result<void> Screen::fit(int width, int height, const ClientSession& session) {
  const FrameSetting& planned = session.plan().setting();
  const bool blends = session.scene().blends();
  const bool same = width == this->width() && height == this->height() &&
                    blends == target_->blends() && planned.samples == samples_ &&
                    planned.scale == scale_;
  if (width < 1 || height < 1 || same || session.awaits_new_scene()) return {};
  Result<void> made = make(width, height, blends, planned.samples, planned.scale);
  if (made) still_.content_changed();
  return made;
}

FrameStep Screen::next(const PlannedFrame& frame, const ClientSession& session) {
  if (session.awaits_new_scene()) {
    still_.content_changed();  // redraws once the new scene is there
    return FrameStep::kKeep;
  }
  if (!still_.unchanged(frame)) return FrameStep::kDraw;
  return session.at_rest() && !refinement_.done() ? FrameStep::kRefine : FrameStep::kKeep;
}

void Screen::draw(FrameRenderer& renderer, const PlannedFrame& frame) {
  renderer.draw(*target_, frame);
  refinement_.restart();
}

void Screen::refine(FrameRenderer& renderer, const PlannedFrame& frame) {
  refinement_.draw_more(renderer, *target_, frame);
}

FrameWork Screen::work(const PlannedFrame& frame) const {
  return work_of(frame, target_->drawn_camera(frame.camera), std::max(target_->samples(), 1));
}

}  // namespace mirage

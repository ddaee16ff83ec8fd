#include "client/screen/screen.h"

#include <algorithm>

#include "client/draw/frame_renderer.h"
#include "client/plan/frame_plan.h"
#include "client/price/frame_work.h"
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

Screen::Step Screen::next(const Camera& camera, const DrawList& list,
                          const ClientSession& session) {
  if (session.awaits_new_scene()) {
    still_.content_changed();  // redraws once the new scene is there
    return Step::kKeep;
  }
  if (!still_.unchanged(camera, session.scene(), list, session.lighting())) return Step::kDraw;
  return session.at_rest() && !refinement_.done() ? Step::kRefine : Step::kKeep;
}

void Screen::draw(FrameRenderer& renderer, const Camera& camera, const DrawList& list,
                  const ClientSession& session) {
  renderer.draw(*target_, camera, session.scene(), list, session.lighting());
  refinement_.restart();
}

void Screen::refine(FrameRenderer& renderer, const Camera& camera, const DrawList& list,
                    const ClientSession& session) {
  refinement_.draw_more(renderer, *target_, camera, session.scene(), list, session.lighting());
}

FrameWork Screen::work(const Camera& camera, const DrawList& list,
                       const ClientSession& session) const {
  return work_of(session.scene(), target_->drawn_camera(camera), list,
                 std::max(target_->samples(), 1));
}

}  // namespace mirage

#include "client/screen/screen.h"

#include <algorithm>
#include <optional>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/draw/refinement.h"
#include "client/frame/planned_frame.h"
#include "client/plan/frame_plan.h"
#include "client/price/frame_work.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "client/session/stillness.h"

namespace mirage {

struct Screen::Parts {
  Result<void> make(int width, int height, bool blends, int samples, double scale);

  std::optional<FrameTarget> target;
  // Planned for the target; the device may not have as many samples.
  int planned_samples = 1;
  double planned_scale = 1;
  Stillness still;
  Refinement refinement;
};

Screen::Screen() : parts_(std::make_unique<Parts>()) {}
Screen::~Screen() = default;
Screen::Screen(Screen&&) noexcept = default;
Screen& Screen::operator=(Screen&&) noexcept = default;

Result<void> Screen::Parts::make(int width, int height, bool blends, int samples, double scale) {
  Result<FrameTarget> made = FrameTarget::create(width, height, samples, blends, scale);
  if (!made) return made.error();
  target.emplace(made.take());
  planned_samples = samples;
  planned_scale = scale;
  return {};
}

Result<void> Screen::create(int width, int height) {
  return parts_->make(width, height, false, 1, 1);
}

bool Screen::created() const { return parts_->target.has_value(); }

Result<void> Screen::fit(int width, int height, const ClientSession& session) {
  Parts& p = *parts_;
  const FrameSetting& planned = session.plan().setting();
  const bool blends = session.scene().blends();
  const bool same = width == this->width() && height == this->height() &&
                    blends == p.target->blends() && planned.samples == p.planned_samples &&
                    planned.scale == p.planned_scale;
  if (width < 1 || height < 1 || same || session.awaits_new_scene()) return {};
  Result<void> made = p.make(width, height, blends, planned.samples, planned.scale);
  if (made) p.still.content_changed();
  return made;
}

void Screen::content_changed() { parts_->still.content_changed(); }

FrameStep Screen::next(const PlannedFrame& frame, const ClientSession& session) {
  Parts& p = *parts_;
  if (session.awaits_new_scene()) {
    p.still.content_changed();  // redraws once the new scene is there
    return FrameStep::kKeep;
  }
  if (!p.still.unchanged(frame)) return FrameStep::kDraw;
  return session.at_rest() && !refined() ? FrameStep::kRefine : FrameStep::kKeep;
}

void Screen::draw(FrameRenderer& renderer, const PlannedFrame& frame) {
  renderer.draw(*parts_->target, frame);
  parts_->refinement.restart();
}

void Screen::refine(FrameRenderer& renderer, const PlannedFrame& frame) {
  parts_->refinement.draw_more(renderer, *parts_->target, frame);
}

FrameWork Screen::work(const PlannedFrame& frame) const {
  return work_of(frame, parts_->target->drawn_camera(frame.camera), std::max(samples(), 1));
}

const FrameTarget& Screen::shown() const { return parts_->refinement.picture(*parts_->target); }
bool Screen::refined() const { return parts_->refinement.done(); }
int Screen::width() const { return parts_->target->width(); }
int Screen::height() const { return parts_->target->height(); }
int Screen::samples() const { return parts_->target->samples(); }
std::size_t Screen::gpu_bytes() const {
  return parts_->target->gpu_bytes() + parts_->refinement.gpu_bytes();
}

}  // namespace mirage

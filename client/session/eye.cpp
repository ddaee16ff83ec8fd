#include "client/session/eye.h"

#include <algorithm>

#include "client/scene/scene_view.h"

namespace mirage {
namespace {

void begin(Eye& eye, const SceneView& scene) {
  constexpr double kSlowestJumpMps = 50, kRadiiAJump = 0.5;
  eye.selector.reset(scene);
  eye.predictor = Predictor(std::max(kSlowestJumpMps, kRadiiAJump * scene.bounds_radius));
}

}  // namespace

void Eyes::resize(std::size_t views, const SceneView& scene) {
  eyes_.resize(std::min(views, eyes_.size()));
  while (eyes_.size() < views) {
    eyes_.push_back(std::make_unique<Eye>());
    begin(*eyes_.back(), scene);
  }
}

void Eyes::reset(const SceneView& scene) {
  for (const auto& eye : eyes_) begin(*eye, scene);
}

void Eyes::grow(const SceneView& scene) {
  for (const auto& eye : eyes_) eye->selector.grow(scene);
}

void Eyes::note_tile(std::uint32_t object, double bytes) {
  for (const auto& eye : eyes_) eye->selector.note_tile(object, bytes);
}

}  // namespace mirage

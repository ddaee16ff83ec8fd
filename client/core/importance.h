#pragma once
// How much error an instance may show, and how urgent it is (TECHNIQUES row 22): by what the scene
// says it is, and by where the viewer looks and points.

#include <optional>

#include "client/core/scene_view.h"
#include "protocol/instance_group.h"

namespace mirage {

/// How much the viewer attends to a sphere: 1 far from where they look, 2 in the middle of the view
/// or under the cursor, 3 for both; half of either at a quarter of the view's height beside it.
/// `cursor_px` from the upper left, in pixels of the view.
double attention(const Camera& camera, const std::optional<glm::dvec2>& cursor_px,
                 const InstanceView& instance);

/// The error an instance may show, in px, from a tau steered up from `target_px`: it rises last
/// where the viewer looks. Without steering attention changes nothing.
double allowed_error_px(double tau_px, double target_px, double attention, Importance importance);

}  // namespace mirage

#pragma once
// How much error an instance may show, and how urgent it is (TECHNIQUES row 22): by what the scene
// says it is, and by where the viewer looks.

#include "protocol/model/scene_types.h"
namespace mirage {

struct Camera;
struct InstanceView;

/// How much the viewer attends to a sphere: 2 in the middle of the view, 1 far from it, 1.5 at a
/// quarter of the view's height beside it.
double attention(const Camera& camera, const InstanceView& instance);

/// The error an instance may show, in px, from a tau steered up from `target_px`: it rises last
/// where the viewer looks. Without steering attention changes nothing.
double allowed_error_px(double tau_px, double target_px, double attention, Importance importance);

}  // namespace mirage

#pragma once
// Importance: how much error an instance may show, and how urgent it is (TECHNIQUES row 22). It
// depends on what the scene says, and on where the viewer looks.

#include "protocol/model/scene_types.h"
namespace mirage {

struct Camera;
struct InstanceView;

/// Returns how much the viewer attends to a sphere: 2 in the middle of the view, 1.5 at a quarter
/// of the view's height beside it, 1 far from it.
double attention(const Camera& camera, const InstanceView& instance);

/// Returns the error, px, that an instance may show, for a tau steered up from `target_px`. The
/// error rises last where the viewer looks. While tau is not steered up, attention changes nothing.
double allowed_error_px(double tau_px, double target_px, double attention, Importance importance);

}  // namespace mirage

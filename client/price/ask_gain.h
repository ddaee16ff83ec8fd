#pragma once
// Ask gain: what a reply is worth. All kinds of asks are ranked in one list by their gain divided
// by their bytes (Scheduler). Unit: FLIP times pixels that the reply improves, times the seconds
// for which it will serve.

#include "client/price/error_model.h"
#include "protocol/impostor/camera.h"

namespace mirage {

/// A reply counts as serving for at most this many seconds, because nobody knows what comes later.
inline constexpr double kLongestLife = 4;

/// Returns the pixels of a disc of radius `radius_px`, at most those of the view. The disc need not
/// be in view yet.
double disc_px(const Camera& camera, double radius_px);
/// Returns the gain of a thing of `area_px` that is shown with `now` and will be shown with `then`.
/// It is at least a thousandth of area times seconds, so that a wanted thing never counts as
/// nothing.
double ask_gain(double area_px, const Wrongs& now, const Wrongs& then, double seconds);

}  // namespace mirage

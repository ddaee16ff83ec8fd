#pragma once
// What asking for something is worth: all kinds of asks are ranked in one list by it, over the
// bytes they take (Scheduler). Unit: FLIP times pixels that it takes away, times the seconds for
// which it will serve.

#include "client/price/error_model.h"
#include "protocol/impostor/camera.h"

namespace mirage {

/// What is asked for is taken to serve for so long at most, seconds: nobody knows what comes then.
inline constexpr double kLongestLife = 4;

/// Pixels of a disc of radius `radius_px`, at most those of the view: it may be beside it yet.
double disc_px(const Camera& camera, double radius_px);
/// Of a thing of `area_px` that is shown by `now` and will be by `then`; at least a thousandth of
/// its area: what is asked for is wanted, however little it changes.
double ask_gain(double area_px, const Wrongs& now, const Wrongs& then, double seconds);

}  // namespace mirage

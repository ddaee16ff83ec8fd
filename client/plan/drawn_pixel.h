#pragma once
// Drawn pixel: how large a pixel of the drawn picture is on the shown one, as far as tiles are
// asked for by it. A picture that is drawn at half the edge and enlarged shows no texel smaller
// than two pixels, so finer tiles would be rendered, sent and uploaded for nothing.
// Input:  the planned scale of each frame, and whether the eye stands.
// Output: the size of a drawn pixel, px, >= 1.
// Thread: the frame loop's.
// Full:   never; it keeps one number.
//
// A scale that falls counts at once. One that rises counts in the mean of a second, because tiles
// for a scale that soon falls again are wasted. A still eye's picture is refined at full size, so
// full tiles are asked for.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace mirage {

class DrawnPixel {
 public:
  double update(double scale, bool stands, std::int64_t now_us) {
    constexpr double kRisesInUs = 1e6, kStepsPerDoubling = 4;
    const double passed = static_cast<double>(std::max<std::int64_t>(now_us - seen_us_, 0));
    seen_us_ = now_us;
    const double share = 1 - std::exp(-passed / kRisesInUs);
    scale_ = scale <= scale_ ? scale : scale_ + share * (scale - scale_);
    // In few steps, because each new size has everything in view looked at again.
    return stands
               ? 1
               : std::exp2(std::round(-kStepsPerDoubling * std::log2(scale_)) / kStepsPerDoubling);
  }

 private:
  double scale_ = 1;
  std::int64_t seen_us_ = 0;
};

}  // namespace mirage

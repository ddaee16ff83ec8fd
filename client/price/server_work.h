#pragma once
// Server work: the time that a tile of some size takes a server to render and encode, learnt from
// replies. On a software renderer a tile of 512 texels takes as long as twenty of 64.
// Input:  replies with the time that the server worked on each.
// Output: the time to expect, by size.
// Thread: the frame loop's.
// Full:   never; it keeps the sums of a fit.
//
// The model is a fixed time and a time for each texel, fitted to the last replies by relative
// error.

#include <cstdint>

#include "client/price/running_fit.h"

namespace mirage {

class ServerWork {
 public:
  /// Learns that the server worked `us` on a tile of this size class. Times under 1 us count as 1
  /// us, and times over 10 s as 10 s: nobody but the server vouches for them.
  void arrived(std::uint8_t size_class, std::int64_t us);
  /// Returns the time to expect for a tile of this size class, us.
  double expected_us(std::uint8_t size_class) const;

 private:
  RunningFit<2> fit_{{0.97, 1e-3, 1000}};
};

}  // namespace mirage

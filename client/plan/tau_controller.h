#pragma once
// Tau controller: steers the global tolerance tau to what the link can do. The frame plan handles
// the time of a frame.
// Input:  the load of the link, measured lately.
// Output: tau.
// Thread: the frame loop's.
// Full:   never; it keeps a fixed state.
//
// It is stable under delay (numerics.md section 4): at most one step a round trip, steps of x1.25
// and x0.8 in log tau, a dead band of 10 % around the target, and several calm rounds before tau
// comes down. A full link has no such band: asks vanish as tau rises and return as it falls. So a
// rise soon after tau came down doubles the wait before it comes down again.

#include <cstdint>

namespace mirage {

struct TauTargets {
  double rate_mbps = 0;  ///< wanted rate down; 0: any
};

/// Load measured lately; NaN: not measured.
struct TauLoad {
  double rate_mbps = 0;
  double saturated_s = 0;  ///< time for which the window has held back asks
};

class TauController {
 public:
  /// Tau stays within `base_px` and 16 times `base_px`.
  TauController(double base_px, const TauTargets& targets)
      : base_px_(base_px), tau_px_(base_px), targets_(targets) {}

  /// Returns the tau to use from now on. A load that is not a number leaves tau unchanged.
  double update(const TauLoad& load, std::int64_t now_us, std::int64_t round_trip_us);
  double tau_px() const { return tau_px_; }

 private:
  double base_px_;
  double tau_px_;
  TauTargets targets_;
  std::int64_t next_action_us_ = 0;
  int calm_rounds_ = 0;
  std::int64_t eased_us_ = INT64_MIN / 2;  ///< when tau last came down
  std::int64_t patience_us_ = 0;           ///< least time between a rise and coming down
  std::int64_t rose_us_ = INT64_MIN / 2;   ///< when it last rose
};

}  // namespace mirage

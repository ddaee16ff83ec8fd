#pragma once
// Steers the global tolerance tau to what the link can do. What a frame may take is the frame
// plan's.
//
// Stable under delay (numerics.md section 4): at most one step a round trip, steps of x1.25 and
// x0.8 in log tau, a dead band of 10 % around the target, and coming back needs several calm
// rounds. A full link has no such band: asks vanish as tau rises and are back as it falls. So a
// rise soon after tau came down doubles how long the next coming down waits.

#include <cstdint>

namespace mirage {

struct TauTargets {
  double rate_mbps = 0;  ///< wanted rate down; 0: any
};

/// What was measured lately; NaN where nothing was.
struct TauLoad {
  double rate_mbps = 0;
  double saturated_s = 0;  ///< how long asks have been held back by the window
};

class TauController {
 public:
  /// tau never falls below `base_px` and never rises above 16 times it.
  TauController(double base_px, const TauTargets& targets)
      : base_px_(base_px), tau_px_(base_px), targets_(targets) {}

  /// tau to use from now on. A measure that is not a number holds tau where it is.
  double update(const TauLoad& load, std::int64_t now_us, std::int64_t round_trip_us);
  double tau_px() const { return tau_px_; }

 private:
  double base_px_;
  double tau_px_;
  TauTargets targets_;
  std::int64_t next_action_us_ = 0;
  int calm_rounds_ = 0;
  std::int64_t eased_us_ = INT64_MIN / 2;  ///< when tau last came down
  std::int64_t patience_us_ = 0;           ///< it comes down no sooner than so long after a rise
  std::int64_t rose_us_ = INT64_MIN / 2;   ///< when it last rose
};

}  // namespace mirage

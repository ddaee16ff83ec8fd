#include "client/plan/tau_controller.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

constexpr double kUp = 1.25, kDown = 0.8;
constexpr double kDeadBand = 0.1;
constexpr int kCalmRounds = 3;       // before tau comes down again
constexpr double kSaturatedS = 1.0;  // a start or a turn of the head may fill the link this long
constexpr double kLargest = 16;      // times the base
constexpr std::int64_t kShortestRoundUs = 50'000;
constexpr std::int64_t kPatienceUs = 1'000'000;
constexpr int kPatienceRounds = 4;  // on a long way the effect of a step shows later
constexpr std::int64_t kLongestPatienceUs = 32'000'000;

}  // namespace

double TauController::update(const TauLoad& load, std::int64_t now_us, std::int64_t round_trip_us) {
  if (now_us < next_action_us_) return tau_px_;
  double strain = 0;
  if (targets_.rate_mbps > 0) strain = std::max(strain, load.rate_mbps / targets_.rate_mbps);
  if (load.saturated_s > kSaturatedS) strain = std::max(strain, 1 + 2 * kDeadBand);
  // std::max ignores a NaN on its right, so look for one separately.
  const double sum = load.rate_mbps + load.saturated_s;
  if (!std::isfinite(sum)) return tau_px_;
  const std::int64_t round = std::max(round_trip_us, kShortestRoundUs);
  const std::int64_t least = std::clamp(kPatienceRounds * round, kPatienceUs, kLongestPatienceUs);
  next_action_us_ = now_us + round;
  if (strain > 1 + kDeadBand) {
    // Coming down was in vain if tau has to rise again soon after.
    const bool in_vain =
        eased_us_ > rose_us_ && now_us - eased_us_ < 2 * std::max(patience_us_, least);
    if (in_vain) patience_us_ = std::clamp(2 * patience_us_, least, kLongestPatienceUs);
    tau_px_ = std::min(tau_px_ * kUp, base_px_ * kLargest);
    rose_us_ = now_us;
    calm_rounds_ = 0;
  } else if (strain < 1 - kDeadBand) {
    const bool patient = now_us - rose_us_ >= patience_us_;
    if (++calm_rounds_ >= kCalmRounds && patient && tau_px_ > base_px_) {
      tau_px_ = std::max(tau_px_ * kDown, base_px_);
      eased_us_ = now_us;
    }
    if (tau_px_ == base_px_ && now_us - rose_us_ > 2 * kLongestPatienceUs) patience_us_ = 0;
  } else {
    calm_rounds_ = 0;
  }
  return tau_px_;
}

}  // namespace mirage

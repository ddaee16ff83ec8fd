#include "client/price/cost_fit.h"

#include <cmath>

namespace mirage {
namespace {
constexpr double kUsualError = 0.3;  // relative; frames beyond it weigh less (P. J. Huber)
constexpr double kShortestMs = 1e-3;
}  // namespace

CostFit::CostFit(const CostModel& first, const RunningFitOptions& options)
    : first_(first), model_(first), fit_(options) {}

void CostFit::add(const FrameWork& work, double ms) {
  if (!std::isfinite(ms) || ms < kShortestMs) return;
  // The logarithm treats twice as long and half as long as equally far off.
  const double off = std::abs(std::log(std::max(model_.ms_of(work), kShortestMs) / ms));
  RunningFit<kWorks>::Row shares{};  // shares of the frame, at first prices
  for (std::size_t i = 0; i < kWorks; ++i) shares[i] = work.amount[i] * first_.ms[i] / ms;
  fit_.add(shares, 1, off > kUsualError ? kUsualError / off : 1);
  for (std::size_t i = 0; i < kWorks; ++i) model_.ms[i] = first_.ms[i] * fit_.factors()[i];
}

}  // namespace mirage

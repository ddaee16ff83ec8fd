#include "client/core/sample_choice.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {
constexpr double kPatienceMs = 1500;
constexpr double kMostOfOneFrame = kPatienceMs / 3;
}  // namespace

bool SampleChoice::note_drawn(double ms) {
  if (!chooses_ || samples_ == 0 || std::isnan(ms)) return false;
  slow_in_a_row_ms_ = ms > slow_ms_ ? slow_in_a_row_ms_ + std::min(ms, kMostOfOneFrame) : 0;
  if (slow_in_a_row_ms_ < kPatienceMs) return false;
  samples_ = 0;
  return true;
}

}  // namespace mirage

#include "client/plan/relight_policy.h"

namespace mirage {
namespace {
constexpr std::int64_t kSecondUs = 1'000'000;
constexpr std::int64_t kWindowSeconds = 4;
constexpr std::size_t kBusySeconds = 2;
constexpr std::int64_t kQuietUs = 5'000'000;
}  // namespace

void RelightPolicy::new_light(std::int64_t now_us) {
  const std::int64_t second = now_us / kSecondUs;
  if (seconds_.empty() || seconds_.back() != second) seconds_.push_back(second);
  while (seconds_.front() <= second - kWindowSeconds) seconds_.pop_front();
  last_us_ = now_us;
  if (seconds_.size() >= kBusySeconds) on_ = true;
}

bool RelightPolicy::relight(std::int64_t now_us) {
  if (choice_ != RelightChoice::kAuto) return choice_ == RelightChoice::kAlways;
  if (on_ && now_us - last_us_ > kQuietUs) on_ = false;
  return on_;
}

}  // namespace mirage

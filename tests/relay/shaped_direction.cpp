#include "tests/relay/shaped_direction.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {
constexpr std::size_t kPacketBytes = 1460;
constexpr std::size_t kAnyRateBytes = 4u << 20;
constexpr double kHeldS = 0.25;  // buffered before a link, as in routers
}  // namespace

std::size_t ShapedDirection::wants() const {
  const double seconds = kHeldS + (shape_.delay_ms + shape_.jitter_ms) * 1e-3;
  const std::size_t most =
      shape_.rate_mbps > 0
          ? std::max(4 * kPacketBytes, static_cast<std::size_t>(shape_.rate_mbps * 125e3 * seconds))
          : kAnyRateBytes;
  return most > held_ ? most - held_ : 0;
}

std::int64_t ShapedDirection::after_outage(std::int64_t us) const {
  const auto begin = std::llround(shape_.outage_at_s * 1e6);
  const auto end = begin + std::llround(shape_.outage_for_s * 1e6);
  return us >= begin && us < end ? end : us;
}

void ShapedDirection::put(const char* bytes, std::size_t size, std::int64_t now_us) {
  std::uniform_real_distribution<double> share(0, 1);
  for (std::size_t at = 0; at < size; at += kPacketBytes) {
    const std::size_t n = std::min(kPacketBytes, size - at);
    const double bits = static_cast<double>(n) * 8;
    const double took_us = shape_.rate_mbps > 0 ? bits / shape_.rate_mbps : 0;
    free_us_ = after_outage(std::max(free_us_, now_us)) + std::llround(took_us);
    const double delay_ms = shape_.delay_ms + shape_.jitter_ms * share(random_);
    last_due_us_ = std::max<std::int64_t>(last_due_us_, free_us_ + std::llround(delay_ms * 1e3));
    packets_.push_back({last_due_us_, std::string(bytes + at, n)});
    held_ += n;
  }
}

std::string ShapedDirection::take(std::int64_t now_us) {
  std::string out;
  while (!packets_.empty() && packets_.front().due_us <= now_us) {
    out += packets_.front().bytes;
    packets_.pop_front();
  }
  held_ -= out.size();
  return out;
}

}  // namespace mirage

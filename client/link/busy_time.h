#pragma once
// Busy time: remembers when something was busy, and gives the share of a recent span.
// Input:  spans in which it was busy.
// Output: the busy share of a span.
// Thread: its owner's.
// Full:   never; it forgets spans that are older than the last share asked for.

#include <algorithm>
#include <cstdint>
#include <deque>
#include <utility>

namespace mirage {

class BusyTime {
 public:
  /// Adds a busy span from `since_us` to `until_us`. Spans come in order of time, without overlaps.
  void add(std::int64_t since_us, std::int64_t until_us) {
    if (until_us > since_us) spans_.emplace_back(since_us, until_us);
  }
  /// Returns the busy share, 0 to 1, of the time from `since_us` to `until_us`. Forgets what ended
  /// before `since_us`, so later calls may not ask about earlier times.
  double share(std::int64_t since_us, std::int64_t until_us) {
    while (!spans_.empty() && spans_.front().second <= since_us) spans_.pop_front();
    std::int64_t busy = 0;
    for (const auto& [since, until] : spans_) {
      busy += std::max<std::int64_t>(std::min(until, until_us) - std::max(since, since_us), 0);
    }
    const std::int64_t all = until_us - since_us;
    return all > 0 ? static_cast<double>(busy) / static_cast<double>(all) : 0;
  }

 private:
  std::deque<std::pair<std::int64_t, std::int64_t>> spans_;
};

}  // namespace mirage

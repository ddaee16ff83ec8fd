#pragma once
// When something was busy, for the share of the last moments in which it was.
// Thread: its owner's. Never full: forgets what is older than it is asked about.

#include <algorithm>
#include <cstdint>
#include <deque>
#include <utility>

namespace mirage {

class BusyTime {
 public:
  /// Busy from `since_us` to `until_us`; in order of time, without overlaps.
  void add(std::int64_t since_us, std::int64_t until_us) {
    if (until_us > since_us) spans_.emplace_back(since_us, until_us);
  }
  /// Of the time from `since_us` to `until_us`, 0 to 1; nothing before `since_us` is asked for
  /// later.
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

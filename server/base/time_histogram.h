#pragma once
// How often something took how long; added to and read by any thread.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace mirage {

class TimeHistogram {
 public:
  /// Upper bounds in µs; above the last there is one more.
  static constexpr std::array<std::int64_t, 16> kBoundsUs = {
      100,    250,     500,     1'000,   2'500,     5'000,     10'000,    25'000,
      50'000, 100'000, 250'000, 500'000, 1'000'000, 2'500'000, 5'000'000, 10'000'000};

  void add(std::int64_t us) {
    std::size_t at = 0;
    while (at < kBoundsUs.size() && us > kBoundsUs[at]) ++at;
    ++counts_[at];
    sum_us_ += static_cast<std::uint64_t>(us > 0 ? us : 0);
  }
  std::uint64_t count(std::size_t bucket) const { return counts_[bucket]; }
  std::uint64_t sum_us() const { return sum_us_; }

 private:
  std::array<std::atomic<std::uint64_t>, kBoundsUs.size() + 1> counts_{};
  std::atomic<std::uint64_t> sum_us_{0};
};

}  // namespace mirage

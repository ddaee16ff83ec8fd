#pragma once
// Time is an input: client logic never reads a wall clock itself.

#include <chrono>
#include <cstdint>

namespace mirage {

/// Source of time in µs since its own start.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t now_us() const = 0;
};

class SteadyClock final : public Clock {
 public:
  std::int64_t now_us() const override {
    return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() -
                                                                 start_)
        .count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A clock that is advanced by hand. A session that uses it is reproducible to the bit.
class VirtualClock final : public Clock {
 public:
  std::int64_t now_us() const override { return now_us_; }
  void advance_to_us(std::int64_t t) {
    if (t > now_us_) now_us_ = t;
  }

 private:
  std::int64_t now_us_ = 0;
};

}  // namespace mirage

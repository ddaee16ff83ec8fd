#pragma once
// Shaped direction: one direction of a shaped link. Bytes go in as they are sent, and come out when
// a link with this delay and rate would have delivered them, in order as with TCP.
// Input:  bytes, and the time.
// Output: bytes that have arrived.
// Thread: any one; the time comes with every call.
// Full:   wants() returns 0, and the sender waits.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <random>
#include <string>
#include <vector>

namespace mirage {

struct LinkShape {
  double delay_ms = 0;     ///< one way
  double jitter_ms = 0;    ///< added to it, uniformly from 0
  double rate_mbps = 0;    ///< 0: any
  double outage_at_s = 0;  ///< from then on, for outage_for_s, nothing is transmitted
  double outage_for_s = 0;
  std::uint32_t seed = 1;
};

class ShapedDirection {
 public:
  explicit ShapedDirection(const LinkShape& shape) : shape_(shape), random_(shape.seed) {}

  /// Returns how many more bytes it takes now: a link holds what is under way and a quarter of a
  /// second.
  std::size_t wants() const;
  void put(const char* bytes, std::size_t size, std::int64_t now_us);
  /// Returns the bytes that have arrived by now and were not taken.
  std::string take(std::int64_t now_us);
  /// Returns the time of the next arrival; INT64_MAX: nothing is under way.
  std::int64_t next_us() const { return packets_.empty() ? INT64_MAX : packets_.front().due_us; }

 private:
  struct Packet {
    std::int64_t due_us = 0;
    std::string bytes;
  };
  std::int64_t after_outage(std::int64_t us) const;

  const LinkShape shape_;
  std::mt19937 random_;
  std::deque<Packet> packets_;
  std::size_t held_ = 0;
  std::int64_t free_us_ = 0;      ///< when everything given so far is transmitted
  std::int64_t last_due_us_ = 0;  ///< later bytes never overtake
};

}  // namespace mirage

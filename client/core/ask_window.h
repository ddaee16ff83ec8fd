#pragma once
// How many bytes may be under way: what the link delivers times the round trip and a slack
// (NUMERICS section 4: outstanding <= rate x (RTT + 50 ms)).
// Input:  what arrives, when it was asked for. Output: the window, round trip and rate.
// Thread: the frame loop's. Never full: keeps the arrivals of a second and a few trips.
//
// The slack is a queue at the bottleneck: a link that gets faster empties it, the rate rises, and
// the window with it. Before any queue has been seen it doubles, and so it does back to the best
// rate lately known. What a window can hide from itself is a round trip that has become longer: the
// shortest one known is forgotten after two periods, and once a period of constant load everything
// is let arrive so that the next is measured without a queue.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace mirage {

class AskWindow {
 public:
  /// A new connection: nothing of the old one will arrive.
  void reset();

  /// A reply. `bytes` as they came, `expected` as they were counted when they were asked for: the
  /// window is compared with the latter.
  void tile_arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes, double expected);
  /// Geometry: tells of the rate, not of the trip.
  void asset_arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes, double expected);

  /// The window in bytes from now on. `held_back_us`: asks have been waiting for it without a break
  /// for so long; 0: not so. `idle`: nothing is under way.
  double update(std::int64_t now_us, std::int64_t held_back_us, bool idle);

  /// Request to reply, median of the last, µs.
  std::int64_t round_trip_us() const;
  /// Bytes of the last second, as Mbit/s.
  double rate_mbps() const;

 private:
  struct Arrival {
    std::int64_t since_us = 0;  ///< when its first byte can have come
    std::int64_t at_us = 0;
    std::size_t bytes = 0;
    double expected = 0;
  };
  void arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes, double expected);
  std::int64_t shortest_trip_us() const;
  bool queued() const;
  double measured_rate(std::int64_t now_us) const;
  void turn_period(std::int64_t now_us, std::int64_t held_back_us);

  std::deque<Arrival> arrivals_;       ///< of the last second
  std::deque<std::int64_t> trips_us_;  ///< the last ones
  /// Of the present period and the one before; INT64_MAX: none.
  std::array<std::int64_t, 2> shortest_us_{INT64_MAX, INT64_MAX};
  std::int64_t period_ends_us_ = 0;
  std::array<double, 4> best_rates_{};  ///< bytes/us, of the present period and those before
  std::int64_t drain_until_us_ = 0;     ///< at the latest
  bool met_limit_ = false;              ///< a queue has been seen
  std::int64_t queued_us_ = 0;          ///< when there was one last
  double window_ = 0;
};

}  // namespace mirage

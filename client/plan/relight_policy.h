#pragma once
// Relight policy: decides whether the client shades tiles itself. A lit tile looks better, and
// costs less to send and to draw. A light that keeps changing makes every lit tile late.

#include <cstdint>
#include <deque>

namespace mirage {

enum class RelightChoice : std::uint8_t { kAuto, kAlways, kNever };

class RelightPolicy {
 public:
  explicit RelightPolicy(RelightChoice choice) : choice_(choice) {}

  /// Notes that the light has become one not seen before. A lamp that goes on and off is not new:
  /// the client soon holds tiles for both.
  void new_light(std::int64_t now_us);
  /// Returns true if the client should shade tiles. Automatic: on when new light came in two of the
  /// last four seconds, off after five seconds without.
  bool relight(std::int64_t now_us);

 private:
  const RelightChoice choice_;
  std::deque<std::int64_t> seconds_;  ///< seconds with new light, within the window
  std::int64_t last_us_ = 0;
  bool on_ = false;
};

}  // namespace mirage

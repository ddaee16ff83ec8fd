#pragma once
// Whether the client shades tiles itself. A lit tile looks better and costs less to send and to
// draw; a light that is never the same for long makes every one of them late.

#include <cstdint>
#include <deque>

namespace mirage {

enum class RelightChoice : std::uint8_t { kAuto, kAlways, kNever };

class RelightPolicy {
 public:
  explicit RelightPolicy(RelightChoice choice) : choice_(choice) {}

  /// The light has become one not seen before. A lamp going on and off is not new: tiles for both
  /// are soon held.
  void new_light(std::int64_t now_us);
  /// Automatic: on when new light came in two of the last four seconds, off after five without.
  bool relight(std::int64_t now_us);

 private:
  const RelightChoice choice_;
  std::deque<std::int64_t> seconds_;  ///< with new light, within the window
  std::int64_t last_us_ = 0;
  bool on_ = false;
};

}  // namespace mirage

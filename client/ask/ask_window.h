#pragma once
// How many bytes may be under way: what the link delivers times the round trip and a slack
// (numerics.md section 4: outstanding <= rate x (RTT + 50 ms)).
// Input:  what arrives, when it was asked for. Output: the window, round trip and rate.
// Thread: the frame loop's. Never full: keeps the arrivals of a few trips.
//
// What the link delivers is measured while it is busy: from when a reply can have come at the
// earliest, or the one before it came, until it came. A gap in which nothing was due says nothing.
// A train too short to measure looks infinitely fast, so the window at most doubles what whole
// trips have brought. The server's own time counts for neither trip nor rate. While hardly a reply
// has waited the link is not full, and the window is not lowered.
//
// The slack is a queue at the bottleneck: a link that gets faster empties it, the rate rises, and
// the window with it. Asks leave with frames, so it lasts from one to the next. What a window can
// hide from itself is a round trip that has become longer: it looks like a queue. After a period in
// which every trip was slow, or a second in which each was longer than any queue of this window,
// all is let arrive, and the next trip tells which it was.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "client/link/tile_trip.h"

namespace mirage {

class AskWindow {
 public:
  /// A new connection: nothing of the old one will arrive.
  void reset();

  /// A frame begins, in which something may be asked for.
  void frame_began(std::int64_t now_us);
  /// The first answer of a connection: its trip is about the shortest there is.
  void welcomed(std::int64_t now_us, std::int64_t trip_us);
  void tile_arrived(const TileTrip& trip);
  /// Geometry: tells of the rate, not of the trip.
  void asset_arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes, double expected);
  /// Of what comes unasked after the welcome, the scene's description and its view.
  void opening_arrived(std::int64_t now_us, std::size_t bytes);
  /// What nobody knows any more when it was asked for tells of neither.
  void stray_arrived(std::int64_t now_us, std::size_t bytes);

  /// The window in bytes from now on. `held_back_us`: asks have been waiting for it without a break
  /// for so long; 0: not so. `idle`: nothing is under way.
  double update(std::int64_t now_us, std::int64_t held_back_us, bool idle);

  /// Every reply of the last moments has waited: the link is full, or its way has become longer.
  bool queued() const;
  /// How long a reply of `bytes` takes that is asked for now, with `under_way` bytes in all.
  std::int64_t trip_us(double bytes, double under_way) const;
  /// What a queue may take, at the link or at the server: asks leave with frames, so it lasts from
  /// one to the next.
  std::int64_t slack_us() const;
  /// There and back, without what waits: the shortest of the last ones; 0 while unknown.
  std::int64_t way_us() const { return shortest_trip().us; }
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
    double timed = 0;  ///< of these, those that took from `since_us` to `at_us`
  };
  struct Trip {
    std::int64_t us = INT64_MAX;
    double bytes = 0;  ///< of the tile, as expected
  };
  void arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes, double expected);
  /// What its tile takes on the link.
  std::int64_t own_us(const Trip& trip) const;
  /// By more than that and a little.
  bool longer(const Trip& trip, const Trip& than) const;
  /// 0 while there was none.
  Trip shortest_trip() const;
  std::int64_t usual_trip_us() const;
  /// Before anything was asked for: what comes in a moment at the rate of the opening.
  double initial_bytes(std::int64_t now_us) const;
  /// Hardly any has.
  bool clear() const;
  std::int64_t span_us() const;
  double busy_rate(std::int64_t now_us) const;
  double whole_rate(std::int64_t now_us) const;
  /// Bytes that wait at the server, not on the link: as many as come while it has each.
  double at_server(std::int64_t now_us) const;
  void drain(std::int64_t now_us, const Trip& shortest);
  void turn_period(std::int64_t now_us);

  std::deque<Arrival> arrivals_;        ///< of the last second, or the last whole trips
  std::deque<std::int64_t> trips_us_;   ///< the last ones
  std::deque<std::int64_t> server_us_;  ///< for which the server had the last ones
  std::deque<bool> long_;               ///< which of them have waited
  Trip far_;  ///< the shortest of those without a break longer than any queue of this window
  std::int64_t far_since_us_ = 0;
  int slow_trips_ = 0;                 ///< one after the other, till now
  std::int64_t slow_since_us_ = 0;     ///< when the first of them came
  std::int64_t slow_until_us_ = 0;     ///< and the last
  std::int64_t opening_us_ = -1;       ///< when the last of it came, or the welcome
  std::int64_t began_us_ = INT64_MAX;  ///< when the first of all can have come
  std::int64_t updated_us_ = 0;
  std::int64_t frame_us_ = -1;          ///< when the last frame began
  std::deque<std::int64_t> frames_us_;  ///< between the last ones
  std::array<Trip, 2> shortest_;        ///< of the present period and the one before
  std::array<double, 2> best_rates_{};  ///< of whole trips, bytes/us, of the same periods
  std::int64_t period_ends_us_ = 0;
  std::int64_t drain_until_us_ = 0;      ///< at the latest
  std::int64_t drained_us_ = INT64_MAX;  ///< what was asked for since tells the shortest trip
  double rate_ = 0;                      ///< of the busy link, bytes/us; 0: unknown
  double initial_ = 0;                   ///< the first window
  double window_ = 0;
};

}  // namespace mirage

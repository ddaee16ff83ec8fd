#pragma once
// Ask window: how many bytes may be under way. It is what the link delivers, times the round trip
// and a slack (numerics.md section 4: outstanding <= rate x (RTT + 50 ms); RTT is the round-trip
// time).
// Input:  replies that arrive, and when they were asked for.
// Output: the window, round trip and rate.
// Thread: the frame loop's.
// Full:   never; it keeps the arrivals of a few trips.
//
// The rate is measured while the link is busy. A reply keeps it busy from the earliest time at
// which it can have arrived, or from the arrival before it, until its own arrival. A gap in which
// nothing was due says nothing. A burst too short to measure looks infinitely fast, so the window
// at most doubles what whole trips have brought. The server's own time counts neither for the trip
// nor for the rate. While hardly a reply has waited, the link is not full, and the window is not
// lowered.
//
// The slack is a queue at the bottleneck. A link that gets faster empties it; the rate rises, and
// the window with it. Asks are sent once a frame, so the queue must last from one frame to the
// next.
//
// A round trip that has become longer looks like a queue, and a window cannot tell them apart. So
// all replies are allowed to arrive after a period in which every trip was slow, or after a second
// in which each trip was longer than any queue of this window. The next trip tells which it was.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "client/link/tile_trip.h"

namespace mirage {

class AskWindow {
 public:
  /// Restarts for a new connection: nothing of the old one will arrive.
  void reset();

  /// Notes the beginning of a frame, in which asks may be sent.
  void frame_began(std::int64_t now_us);
  /// Notes the first reply of a connection. Its trip is about the shortest there is.
  void welcomed(std::int64_t now_us, std::int64_t trip_us);
  void tile_arrived(const TileTrip& trip);
  /// Notes geometry or an image, which tells of the rate, not of the trip.
  void asset_arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes, double expected);
  /// Notes a part of the opening: the scene's description and its view, which come unasked after
  /// the welcome.
  void opening_arrived(std::int64_t now_us, std::size_t bytes);
  /// Notes a reply whose request is forgotten. It tells neither the rate of the busy link nor a
  /// trip.
  void stray_arrived(std::int64_t now_us, std::size_t bytes);

  /// Returns the window in bytes from now on. `held_back_us` is the time for which asks have been
  /// waiting for it without a break; 0: none wait. `idle`: nothing is under way.
  double update(std::int64_t now_us, std::int64_t held_back_us, bool idle);

  /// True if all recent replies have waited: the link is full, or its way has become longer.
  bool queued() const;
  /// Returns how long a reply of `bytes` takes, µs, if it is asked for now and `under_way` bytes
  /// are under way in all.
  std::int64_t trip_us(double bytes, double under_way) const;
  /// Returns the time that a queue may take, µs, at the link or at the server. Asks are sent once a
  /// frame, so the queue lasts from one frame to the next.
  std::int64_t slack_us() const;
  /// Returns the shortest recent trip there and back, µs, in which nothing waited; 0: unknown.
  std::int64_t way_us() const { return shortest_trip().us; }
  /// Returns the bytes that would arrive within `seconds` if nothing else were under way. Before
  /// the link has told its rate, it is what the window takes.
  double spare_bytes(double seconds) const;
  /// Returns the time from request to reply, µs: the median of the last ones.
  std::int64_t round_trip_us() const;
  /// Returns the bytes received in the last second, as Mbit/s.
  double rate_mbps() const;

 private:
  struct Arrival {
    std::int64_t since_us = 0;  ///< earliest time for its first byte
    std::int64_t at_us = 0;
    std::size_t bytes = 0;
    double expected = 0;
    double timed = 0;  ///< part of `expected` that took from `since_us` to `at_us`
  };
  struct Trip {
    std::int64_t us = INT64_MAX;
    double bytes = 0;  ///< expected bytes of its tile
  };
  void arrived(std::int64_t sent_us, std::int64_t now_us, std::size_t bytes, double expected);
  /// Returns the time that the trip's tile takes on the link, µs.
  std::int64_t own_us(const Trip& trip) const;
  /// True if `trip`, without its tile's time on the link, is longer than `than` by more than
  /// kQueueUs.
  bool longer(const Trip& trip, const Trip& than) const;
  /// Returns the shortest trip of the last two periods; 0: there was none.
  Trip shortest_trip() const;
  std::int64_t usual_trip_us() const;
  /// Returns the first window: the bytes that arrive in a usual trip at the rate of the opening.
  double initial_bytes(std::int64_t now_us) const;
  /// True if hardly any of the last replies has waited.
  bool clear() const;
  std::int64_t span_us() const;
  double busy_rate(std::int64_t now_us) const;
  double whole_rate(std::int64_t now_us) const;
  /// Returns the bytes that wait at the server, not on the link: those that arrive while it has a
  /// tile.
  double at_server(std::int64_t now_us) const;
  void drain(std::int64_t now_us, const Trip& shortest);
  void turn_period(std::int64_t now_us);

  std::deque<Arrival> arrivals_;        ///< of the last second, or of the last whole trips
  std::deque<std::int64_t> trips_us_;   ///< the last trips
  std::deque<std::int64_t> server_us_;  ///< time for which the server had the last tiles
  std::deque<bool> long_;               ///< which of the last trips have waited
  Trip far_;  ///< shortest of the present run of trips longer than any queue
  std::int64_t far_since_us_ = 0;
  int slow_trips_ = 0;              ///< trips in a row that have waited, until now
  std::int64_t slow_since_us_ = 0;  ///< when the first of them arrived
  std::int64_t slow_until_us_ = 0;  ///< when the last of them arrived
  /// Time when the last part of the opening arrived, or the welcome.
  std::int64_t opening_us_ = -1;
  std::int64_t began_us_ = INT64_MAX;  ///< earliest time for the first byte of all
  std::int64_t updated_us_ = 0;
  std::int64_t frame_us_ = -1;          ///< when the last frame began
  std::deque<std::int64_t> frames_us_;  ///< times between the last frames
  std::array<Trip, 2> shortest_;        ///< of the present period and the former one
  std::array<double, 2> best_rates_{};  ///< of whole trips, bytes/us, in these periods
  std::int64_t period_ends_us_ = 0;
  std::int64_t drain_until_us_ = 0;      ///< latest end of a drain; 0: none
  std::int64_t drained_us_ = INT64_MAX;  ///< asks sent since then tell the shortest trip
  double rate_ = 0;                      ///< rate of the busy link, bytes/us; 0: unknown
  double initial_ = 0;                   ///< the first window
  double window_ = 0;
};

}  // namespace mirage

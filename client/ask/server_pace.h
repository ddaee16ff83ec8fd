#pragma once
// Server pace: how many tiles may be under way. It is what the server completes during the way
// there and back and a slack.
// Input:  replies with the server's own time, and how many asks were under way with each.
// Output: the most tiles to have under way.
// Thread: the frame loop's.
// Full:   never; it keeps the last replies.
//
// A slow server is a resource of its own. Asks beyond what it completes wait there, ranked by what
// was known when they were sent, and half of them are no longer needed when their turn comes.
//
// Its rate is counted where it worked without a break: it already had the next ask when it finished
// a tile. When it finished a tile follows without the link, from when the ask was sent and how long
// the server had it.
//
// If most replies have waited for at least half the slack, no more may be under way than the server
// completes in way and slack (Little's law). Otherwise the limit is twice as many as there were,
// and no fewer than it completed when it was last at its limit.

#include <cstddef>
#include <cstdint>
#include <deque>

#include "client/link/tile_trip.h"

namespace mirage {

class ServerPace {
 public:
  /// Sets the time of a tile, µs, that the server announces before the first one; 0: it does not
  /// know.
  void expect(std::int64_t tile_us);
  void tile_arrived(const TileTrip& trip);
  /// Returns the time for which the server had the last tiles: their median, µs.
  std::int64_t server_us() const;
  /// True if it ever was at its limit.
  bool at_limit() const { return per_us_ > 0; }
  /// Returns the most tiles to have under way. `way_us` is the way there and back, as far as known
  /// before a tile has arrived; `slack_us` is the time that asks may wait at the server.
  std::size_t limit(std::int64_t way_us, std::int64_t slack_us);

 private:
  struct Reply {
    std::size_t under_way = 0;
    std::int64_t way_us = 0, server_us = 0;
    /// Time when the server finished it, if the ask took no time to get there.
    std::int64_t finished_us = 0;
  };
  /// Returns the tiles/us of the last replies while the server worked without a break; 0: it never
  /// did.
  double completes() const;

  std::deque<Reply> last_;
  std::int64_t expected_us_ = 0;  ///< expected time of a tile, before any has arrived
  double per_us_ = 0;             ///< tiles/us when it was last at its limit; 0: never
};

}  // namespace mirage

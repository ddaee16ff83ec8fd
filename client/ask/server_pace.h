#pragma once
// How many tiles may be under way: what the server completes in the way there and back and a slack.
// Input:  replies with the server's own time, and how many asks were under way with each.
// Output: the most to have under way. Thread: the frame loop's. Never full: keeps the last replies.
//
// A slow server is a resource of its own: asks beyond what it completes wait there, ranked by what
// was known when they were sent, and half of them are no longer needed when their turn comes. What
// it completes is counted where it was at work without a break: a reply that it had since before it
// finished the one before. When each was finished is known without the link: it was asked for, and
// the server had it for so long. Where most replies have waited for half the slack and more, no
// more may be under way than it completes in way and slack (Little's law). Otherwise twice as many
// as there were, and no fewer than it completed when it was last seen at its limit.

#include <cstddef>
#include <cstdint>
#include <deque>

#include "client/link/tile_trip.h"

namespace mirage {

class ServerPace {
 public:
  /// What a tile takes, as the server says before the first has come; 0: it does not know.
  void expect(std::int64_t tile_us);
  void tile_arrived(const TileTrip& trip);
  /// For how long the server has had the last ones: their median, µs.
  std::int64_t server_us() const;
  /// What it makes a tile in when it is at its limit, µs; 0: it never was.
  double tile_us() const { return per_us_ > 0 ? 1 / per_us_ : 0; }
  /// The most tiles to have under way; `way_us`: there and back, as far as known before a tile has
  /// come; `slack_us`: what may wait at the server.
  std::size_t limit(std::int64_t way_us, std::int64_t slack_us);

 private:
  struct Reply {
    std::size_t under_way = 0;
    std::int64_t way_us = 0, server_us = 0;
    std::int64_t finished_us = 0;  ///< by the server, as if the ask had taken no time to get there
  };
  /// Tiles/us of the last replies, while it was at work without a break; 0: it never was.
  double completes() const;

  std::deque<Reply> last_;
  std::int64_t expected_us_ = 0;  ///< a tile, before any has come
  double per_us_ = 0;  ///< tiles it completed when it was last at its limit; 0: it never was
};

}  // namespace mirage

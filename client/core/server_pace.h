#pragma once
// How many tiles may be under way: what the server completes in the way there and back and a slack.
// Input:  replies with the server's own time, and how many asks were under way with each.
// Output: the most to have under way. Thread: the frame loop's. Never full: keeps the last replies.
//
// A slow server is a resource of its own: asks beyond what it completes wait there, ranked by what
// was known when they were sent, and half of them are no longer needed when their turn comes. Where
// most replies have waited there for half the slack and more, n asks answered within way + server
// are n / (way + server) a second (Little's law); the best of the last replies counts, as those at
// the front of a batch had fewer beside them. Otherwise twice as many as there were may be under
// way, and no fewer than it completed when it was last seen at its limit, or would one after the
// other.

#include <cstddef>
#include <cstdint>
#include <deque>

namespace mirage {

class ServerPace {
 public:
  /// A reply. `under_way`: asks without a reply when it was sent, itself among them; `trip_us`:
  /// from ask to reply, of which the server had it for `server_us`.
  void tile_arrived(std::size_t under_way, std::int64_t trip_us, std::int64_t server_us);
  /// For how long the server has had the last ones: their median, µs.
  std::int64_t server_us() const;
  /// The most tiles to have under way; `slack_us`: what may wait at the server.
  std::size_t limit(std::int64_t slack_us);

 private:
  struct Reply {
    std::size_t under_way = 0;
    std::int64_t way_us = 0, server_us = 0;
  };
  std::deque<Reply> last_;
  double per_us_ = 0;  ///< tiles it completed when it was last at its limit; 0: it never was
};

}  // namespace mirage

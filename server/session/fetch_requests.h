#pragma once
// Asks that wait for the tile sources, and the time they wait.
// Input:  asks that memory could not answer
// Output: jobs of the fetch stage
// Thread: the network loop's
// Full:   an ask skips the sources, as it does while they are slow

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "protocol/base/bounded_queue.h"
#include "protocol/base/clock.h"
#include "protocol/codec/tile_codec.h"
#include "server/tile/tile_job.h"

namespace mirage {

class FetchRequests {
 public:
  /// An ask is given up after `patience_us`.
  FetchRequests(BoundedQueue<FetchJob>& jobs, const Clock& clock, std::int64_t patience_us)
      : jobs_(jobs), clock_(clock), patience_us_(patience_us) {}

  /// Requests a look into the sources, once for all asks that wait for the same codec. False: the
  /// tile must be rendered without looking.
  bool wait(const TileAsk& ask);
  /// Ends a look and returns the asks that waited for it.
  std::vector<TileAsk> take(const TileId& id, TileCodec codec);
  /// Returns the asks that waited too long. Later asks then skip the sources for a while, which
  /// doubles until a tile arrives in time.
  std::vector<TileAsk> take_overdue();
  /// Lets the waiting asks wait longer, because another server renders the tile.
  void be_patient(const TileId& id, TileCodec codec);
  /// Cancels an ask; false if it does not wait here.
  bool cancel(SessionId session, std::uint32_t request_id);
  void remove_session(SessionId session);
  bool waiting() const { return !looked_for_.empty(); }
  /// Number of waiting asks of a session.
  std::size_t asks_of(SessionId session) const;

 private:
  struct LookedFor {
    std::int64_t until_us = 0;
    std::vector<TileAsk> asks;
  };
  bool sources_are_slow() const;

  BoundedQueue<FetchJob>& jobs_;
  const Clock& clock_;
  const std::int64_t patience_us_;
  std::map<FormId, LookedFor> looked_for_;
  std::map<std::pair<SessionId, std::uint32_t>, FormId> requests_;
  std::int64_t avoid_until_us_ = INT64_MIN, avoid_us_ = 0;
  bool on_trial_ = false;  ///< the sources were slow: one tile at a time, until one arrives in time
};

}  // namespace mirage

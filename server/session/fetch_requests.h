#pragma once
// Who waits for tiles that are looked for in the sources, and how long.
// Input:  asks that memory could not answer. Output: jobs of the fetch stage.
// Thread: the network loop's.
// Full:   an ask goes past the sources, as it does while they are slow.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "protocol/base/bounded_queue.h"
#include "protocol/base/clock.h"
#include "server/tile/tile_job.h"

namespace mirage {

class FetchRequests {
 public:
  /// An ask is given up after `patience_us`.
  FetchRequests(BoundedQueue<FetchJob>& jobs, const Clock& clock, std::int64_t patience_us)
      : jobs_(jobs), clock_(clock), patience_us_(patience_us) {}

  /// Has the tile looked for, once for all who wait for it in the waiter's codec. False: it is to
  /// be rendered without looking.
  bool wait(const TileAsk& ask);
  /// It was looked for; they wait no longer.
  std::vector<TileAsk> take(const TileId& id, TileCodec codec);
  /// Those for whom it takes too long; from now on asks go past the sources for a while, which
  /// doubles until a tile comes in time.
  std::vector<TileAsk> take_overdue();
  /// Another server renders it: who waits for it waits longer.
  void be_patient(const TileId& id, TileCodec codec);
  /// False: it does not wait here.
  bool cancel(SessionId session, std::uint32_t request_id);
  void remove_session(SessionId session);
  bool waiting() const { return !looked_for_.empty(); }
  /// Asks of a session that wait.
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
  bool on_trial_ = false;  ///< it was slow: one tile at a time, until one comes in time
};

}  // namespace mirage

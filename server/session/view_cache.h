#pragma once
// Encoded views, and the requests that wait for a view under way.
// Input:  requests; encoded views
// Output: jobs of the render stage
// Thread: the network loop's
// Full:   the view made longest ago is dropped first; a client waits for one view at a time

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "protocol/wire/view_codec.h"
#include "server/base/byte_budget.h"
#include "server/base/wait_list.h"
#include "server/tile/tile_queue.h"

namespace mirage {

class ViewCache {
 public:
  /// A request that waits for a view.
  struct Waiting {
    SessionId session = 0;
    std::uint32_t request_id = 0;
    std::int64_t asked_us = 0;
    bool kept = false;  ///< the view existed or was under way when it was asked for
  };

  explicit ViewCache(TileQueue& queue) : queue_(queue) {}

  /// Returns an encoded view; nullptr: not here.
  std::shared_ptr<const EncodedView> find(const TileId& id) const;
  /// Requests a view, made once for all its waiters. False: this session waits for one already, or
  /// too many views are under way.
  bool wait(ViewJob job, Waiting waiting);
  /// Requests the home view before any client does, made when there is nothing else to do. It is
  /// never dropped.
  void keep_ready(ViewJob job);
  /// Ends the making of a view (null: it failed) and returns its waiters.
  std::vector<Waiting> finish(const TileId& id, std::shared_ptr<const EncodedView> view);
  void remove_session(SessionId session);
  /// Number of views that a session waits for, at most one.
  std::size_t asks_of(SessionId session) const;

 private:
  TileQueue& queue_;
  WaitList<TileId, Waiting> making_;
  std::unordered_map<TileId, std::shared_ptr<const EncodedView>> made_;
  ByteBudget<TileId> budget_{16u << 20};  ///< of made_ without the home view: some 100 KB each
  std::optional<TileId> home_;            ///< never dropped
};

}  // namespace mirage

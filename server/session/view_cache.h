#pragma once
// Views as they are sent: who waits for one that is being made, and those that were made.
// Input:  requests, encoded views. Output: jobs of the render stage.
// Thread: the network loop's.
// Full:   the view made longest ago goes first; a client waits for one at a time.

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
  /// Who asked for a view.
  struct Waiting {
    SessionId session = 0;
    std::uint32_t request_id = 0;
    std::int64_t asked_us = 0;
    bool kept = false;  ///< it was there or on its way
  };

  explicit ViewCache(TileQueue& queue) : queue_(queue) {}

  /// nullptr: not here.
  std::shared_ptr<const EncodedView> find(const TileId& id) const;
  /// Has the view made, once for all who wait. False: this session waits for one already.
  bool wait(ViewJob job, Waiting waiting);
  /// The same for nobody yet, when there is nothing else to do; it is never let go.
  void keep_ready(ViewJob job);
  /// A view is made (null: it could not be): who waited for it.
  std::vector<Waiting> finish(const TileId& id, std::shared_ptr<const EncodedView> view);
  void remove_session(SessionId session);
  /// Views that a session waits for: one at most.
  std::size_t asks_of(SessionId session) const;

 private:
  TileQueue& queue_;
  WaitList<TileId, Waiting> making_;
  std::unordered_map<TileId, std::shared_ptr<const EncodedView>> made_;
  ByteBudget<TileId> budget_{16u << 20};  ///< of made_ but home: some 100 KB each
  std::optional<TileId> home_;            ///< is not let go
};

}  // namespace mirage

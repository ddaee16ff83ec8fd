#pragma once
// Which keys have been rendered before: a tile is to be rendered once, by merging and by the store.
// GL thread only.

#include <cstddef>
#include <deque>
#include <unordered_set>

#include "server/tile/tile_job.h"

namespace mirage {

class RenderedKeys {
 public:
  /// Remembers the last `most` keys.
  explicit RenderedKeys(std::size_t most = 1u << 16) : most_(most) {}

  /// False: it is one of those remembered.
  bool add(const TileId& id) {
    if (!known_.insert(id).second) return false;
    order_.push_back(id);
    if (order_.size() > most_) {
      known_.erase(order_.front());
      order_.pop_front();
    }
    return true;
  }

 private:
  const std::size_t most_;
  std::unordered_set<TileId> known_;
  std::deque<TileId> order_;  ///< oldest first
};

}  // namespace mirage

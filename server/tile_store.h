#pragma once
// Tile store: finished tiles by id, in memory under a byte budget (least recently used go first),
// and optionally in a directory, which outlives the process. Any thread.

#include <list>
#include <mutex>
#include <unordered_map>

#include "server/cache_directory.h"
#include "server/counters.h"
#include "server/tile_job.h"

namespace mirage {

class TileStore {
 public:
  /// `directory` nullptr: memory only; else it outlives the store.
  TileStore(std::size_t budget_bytes, CacheDirectory* directory, Counters& counters);

  /// The tile, from memory or the directory; nullptr when it must be rendered.
  StoredTilePtr find(const TileId& id);
  /// Into memory.
  void put(const TileId& id, StoredTilePtr tile);
  /// Into the directory, where there is one. Apart from put(): nobody is to wait for a disk.
  void save(const TileId& id, const StoredTile& tile) const;

 private:
  struct Slot {
    StoredTilePtr tile;
    std::list<TileId>::iterator age;
  };
  StoredTilePtr load(const TileId& id) const;

  const std::size_t budget_;
  CacheDirectory* const directory_;
  Counters& counters_;
  std::mutex mutex_;
  std::unordered_map<TileId, Slot> slots_;
  std::list<TileId> ages_;  ///< most recently used first
  std::size_t bytes_ = 0;
};

}  // namespace mirage

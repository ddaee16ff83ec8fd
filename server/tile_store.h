#pragma once
// Tile store: finished tiles by id, in memory under a byte budget (least recently used go first),
// and optionally in a directory. Any thread.

#include <list>
#include <mutex>
#include <string>
#include <unordered_map>

#include "server/counters.h"
#include "server/tile_job.h"

namespace mirage {

class TileStore {
 public:
  /// `directory` empty: memory only.
  TileStore(std::size_t budget_bytes, std::string directory, Counters& counters);

  /// The tile, from memory or the directory; nullptr when it must be rendered.
  StoredTilePtr find(const TileId& id);
  void put(const TileId& id, StoredTilePtr tile);

 private:
  struct Slot {
    StoredTilePtr tile;
    std::list<TileId>::iterator age;
  };
  void put_in_memory(const TileId& id, StoredTilePtr tile);
  std::string path(const TileId& id) const;
  StoredTilePtr load(const TileId& id) const;
  void save(const TileId& id, const StoredTile& tile) const;

  const std::size_t budget_;
  const std::string directory_;
  Counters& counters_;
  std::mutex mutex_;
  std::unordered_map<TileId, Slot> slots_;
  std::list<TileId> ages_;  ///< most recently used first
  std::size_t bytes_ = 0;
};

}  // namespace mirage

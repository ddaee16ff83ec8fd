#pragma once
// Tile store: finished tiles by id, in memory under a byte budget (least recently used go first,
// all their forms together), and optionally in a directory, which outlives the process. Any thread.

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

  /// The form that was made for `codec`, from memory or the directory; nullptr when it must be.
  StoredTilePtr find(const TileId& id, TileCodec codec);
  /// A form without loss to make others from; nullptr when the tile must be rendered.
  StoredTilePtr find_lossless(const TileId& id);
  /// Into memory: the form that was made for `codec`; it may be in another, where that is smaller.
  void put(const TileId& id, TileCodec codec, StoredTilePtr tile);
  /// Into the directory, where there is one. Apart from put(): nobody is to wait for a disk. All
  /// forms without loss share one file; lossy ones have their own.
  void save(const TileId& id, TileCodec codec, const StoredTile& tile) const;

 private:
  struct Slot {
    std::array<StoredTilePtr, kTileCodecs.size()> forms;  ///< by the codec they were made for
    std::size_t bytes = 0;
    std::list<TileId>::iterator age;
  };
  StoredTilePtr find_in_memory(const TileId& id, const std::vector<TileCodec>& codecs);
  StoredTilePtr load(const TileId& id, TileCodec form) const;

  const std::size_t budget_;
  CacheDirectory* const directory_;
  Counters& counters_;
  std::mutex mutex_;
  std::unordered_map<TileId, Slot> slots_;
  std::list<TileId> ages_;  ///< most recently used first
  std::size_t bytes_ = 0;
};

}  // namespace mirage

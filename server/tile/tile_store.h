#pragma once
// Tile store: finished tiles by id, in memory under a byte budget (least recently used go first,
// all their forms together), and optionally in a directory, which outlives the process. Any thread;
// fetch() and save() take as long as the disk does and are the fetch stage's.

#include <mutex>
#include <unordered_map>

#include "server/base/byte_budget.h"
#include "server/base/cache_directory.h"
#include "server/base/counters.h"
#include "server/tile/tile_job.h"

namespace mirage {

class TileStore {
 public:
  /// `directory` nullptr: memory only; else it outlives the store.
  TileStore(std::size_t budget_bytes, CacheDirectory* directory, Counters& counters);

  /// The form that was made for `codec`; nullptr: it is not in memory.
  StoredTilePtr find(const TileId& id, TileCodec codec);
  /// A form without loss to make others from; nullptr: it is not in memory.
  StoredTilePtr find_lossless(const TileId& id);
  /// Into memory: the form that was made for `codec`; it may be in another, where that is smaller.
  void put(const TileId& id, TileCodec codec, StoredTilePtr tile);

  bool has_directory() const { return directory_ != nullptr; }
  /// From the directory into memory.
  FetchedTile fetch(const TileId& id, TileCodec codec);
  /// Into the directory, where there is one. All forms without loss share one file; lossy ones have
  /// their own.
  void save(const TileId& id, TileCodec codec, const StoredTile& tile) const;

 private:
  struct Slot {
    std::array<StoredTilePtr, kCodecNumbers> forms;  ///< by the codec they were made for
    ByteBudget<TileId>::Place place;
  };
  StoredTilePtr find_in_memory(const TileId& id, const std::vector<TileCodec>& codecs);
  StoredTilePtr load(const TileId& id, TileCodec form) const;

  CacheDirectory* const directory_;
  Counters& counters_;
  std::mutex mutex_;
  std::unordered_map<TileId, Slot> slots_;
  ByteBudget<TileId> budget_;
};

}  // namespace mirage

#pragma once
// Tile store: finished tiles by id, in memory under a byte budget (least recently used go first,
// all their forms together), and behind it the sources, asked in order. Any thread; what asks the
// sources takes as long as they do and is the fetch stage's.

#include <mutex>
#include <unordered_map>

#include "server/base/byte_budget.h"
#include "server/base/counters.h"
#include "server/tile/tile_job.h"

namespace mirage {

class TileSource;

/// From the fastest to the slowest; they outlive who is told of them.
using TileSources = std::vector<TileSource*>;

class TileStore {
 public:
  TileStore(std::size_t budget_bytes, TileSources sources, Counters& counters);

  /// The form that was made for `codec`; nullptr: it is not in memory.
  StoredTilePtr find(const TileId& id, TileCodec codec);
  /// A form without loss to make others from; nullptr: it is not in memory.
  StoredTilePtr find_lossless(const TileId& id);
  /// Into memory: the form that was made for `codec`; it may be in another, where that is smaller.
  void put(const TileId& id, TileCodec codec, StoredTilePtr tile);

  bool has_sources() const { return !sources_.empty(); }
  /// That of the most patient.
  std::int64_t patience_us() const;
  /// From the sources into memory.
  FetchedTile fetch(const TileId& id, TileCodec codec);
  /// Before it is rendered. False: another server is about to have it.
  bool claim(const TileId& id);
  /// Into all sources. All forms without loss share one record; lossy ones have their own.
  void save(const TileId& id, TileCodec codec, const StoredTile& tile) const;

 private:
  struct Slot {
    std::array<StoredTilePtr, kCodecNumbers> forms;  ///< by the codec they were made for
    ByteBudget<TileId>::Place place;
  };
  StoredTilePtr find_in_memory(const TileId& id, const std::vector<TileCodec>& codecs);
  StoredTilePtr load(const TileId& id, TileCodec form) const;

  const TileSources sources_;
  Counters& counters_;
  std::mutex mutex_;
  std::unordered_map<TileId, Slot> slots_;
  ByteBudget<TileId> budget_;
};

}  // namespace mirage

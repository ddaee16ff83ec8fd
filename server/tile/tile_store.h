#pragma once
// Tile store: finished tiles by id. Memory holds them under a byte budget; the tile used longest
// ago is dropped first, with all its forms. Behind memory are the sources, asked in order.
// Thread: any; calls that ask the sources take as long as they do, and belong to the fetch stage.

#include <mutex>
#include <unordered_map>

#include "server/base/byte_budget.h"
#include "server/base/counters.h"
#include "server/tile/tile_job.h"

namespace mirage {

class TileSource;

/// Tile sources from the fastest to the slowest; they must outlive their users.
using TileSources = std::vector<TileSource*>;

class TileStore {
 public:
  TileStore(std::size_t budget_bytes, TileSources sources, Counters& counters);

  /// Returns the form made for `codec`; nullptr: not in memory.
  StoredTilePtr find(const TileId& id, TileCodec codec);
  /// Returns a lossless form to make others from; nullptr: not in memory.
  StoredTilePtr find_lossless(const TileId& id);
  /// Stores in memory the form made for `codec`. It may be in another codec that is smaller.
  void put(const TileId& id, TileCodec codec, StoredTilePtr tile);

  bool has_sources() const { return !sources_.empty(); }
  /// Returns the longest patience of all sources, µs.
  std::int64_t patience_us() const;
  /// Loads a tile from the sources into memory.
  FetchedTile fetch(const TileId& id, TileCodec codec);
  /// Claims a tile before rendering it. False: another server is rendering it.
  bool claim(const TileId& id);
  /// Saves a tile to all sources. All lossless forms share one record; lossy forms have their own.
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

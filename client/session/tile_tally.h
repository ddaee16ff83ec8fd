#pragma once
// Tile tally: counts tiles by fate: received, in which codec, drawn or never drawn.

#include <cstdint>
#include <vector>

#include "client/frame/resident.h"
#include "client/session/counts.h"
#include "client/session/tile_trace.h"

namespace mirage {

namespace wire {
struct TileReplyT;
}

class TileTally {
 public:
  std::uint64_t received = 0;
  std::uint64_t refused = 0;
  std::uint64_t drawn = 0;
  TileTrace trace;

  void note_decoded(const wire::TileReplyT& reply, std::size_t bytes);
  /// Notes a tile that is held and not drawn yet. `life` is its place in the trace, if one is kept.
  void note_held(const TileRecordPtr& tile, std::size_t life) { undrawn_.push_back({tile, life}); }
  /// Counts the tiles that the present frame draws for the first time.
  void note_first_drawn(std::int64_t now_us);
  const CodecUses& codecs() const { return codecs_; }

 private:
  struct Undrawn {
    std::weak_ptr<const TileRecord> tile;
    std::size_t life = SIZE_MAX;
  };
  CodecUses codecs_;
  std::vector<Undrawn> undrawn_;
};

}  // namespace mirage

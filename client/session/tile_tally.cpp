#include "client/session/tile_tally.h"

#include <algorithm>

#include "client/hold/tile_cache.h"
#include "wire_generated.h"

namespace mirage {

void TileTally::note_decoded(const wire::TileReplyT& reply, std::size_t bytes) {
  CodecUse& use = codecs_[reply.codec];
  ++use.tiles;
  use.bytes += bytes;
  if (is_lossy(static_cast<TileCodec>(reply.codec))) use.color_rms.push_back(reply.color_rms);
  use.color_max = std::max(use.color_max, reply.color_max);
}

void TileTally::note_first_drawn(std::int64_t now_us) {
  const auto done = [&](const Undrawn& one) {
    const TileRecordPtr record = one.tile.lock();
    if (record && record->shown) {
      ++drawn;
      trace.first_in_frame(one.life, now_us);
    }
    return !record || record->shown;
  };
  undrawn_.erase(std::remove_if(undrawn_.begin(), undrawn_.end(), done), undrawn_.end());
}

}  // namespace mirage

#pragma once
// Forms of a tile: the same tile in one codec or another.

#include "server/tile/tile_job.h"

namespace mirage {

/// The form without loss that is made and kept for somebody who asks for `codec`.
inline TileCodec lossless_codec(TileCodec codec) {
  return is_lossy(codec) ? TileCodec::kZstd : codec;
}
/// `tile` in a codec. `fields`: those that are no matter of the form; crop, measure, hash, colour
/// error and codec are set here, the time it took is added. A lossy form is decoded again: hash
/// and error are of what comes out. Null when an encoder fails.
StoredTilePtr make_form(const Tile& tile, wire::TileReplyT fields, TileCodec codec);
/// The same from a form without loss; null when that does not decode. Where a lossy form would be
/// no smaller, the zstd form.
StoredTilePtr convert_form(const StoredTilePtr& lossless, TileCodec codec);
/// The lossy form, where it is smaller.
StoredTilePtr smaller_form(StoredTilePtr lossless, StoredTilePtr lossy);

}  // namespace mirage

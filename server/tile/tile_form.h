#pragma once
// Forms of a tile: the same tile in different codecs.

#include "protocol/impostor/tile.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// Returns the codec of the lossless form that is made and kept when `codec` is asked for.
inline TileCodec lossless_codec(TileCodec codec) {
  return is_lossy(codec) ? TileCodec::kZstd : codec;
}
/// Encodes `tile` in a codec; null if an encoder fails. `fields`: those independent of the form.
/// Crop, measure, hash, colour error and codec are set here, and the encoding time is added. A
/// lossy form is decoded again: its hash and error are those of the decoded tile.
StoredTilePtr make_form(const Tile& tile, wire::TileReplyT fields, TileCodec codec);
/// Makes a form from a lossless form; null if that cannot be decoded. Returns the zstd form if a
/// lossy form would be no smaller.
StoredTilePtr convert_form(const StoredTilePtr& lossless, TileCodec codec);
/// Returns the lossy form if it is smaller, else the lossless one.
StoredTilePtr smaller_form(StoredTilePtr lossless, StoredTilePtr lossy);

}  // namespace mirage

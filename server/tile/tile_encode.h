#pragma once
// Turns a rendered tile into a stored one: cuts it out of its page, measures it, encodes it. Pure
// functions.

#include "protocol/impostor/object_proxy.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// Returns the tile's content, cropped, with its measured bounds.
Tile cut_and_measure(const RenderedTile& rendered, const ObjectDescription& object);
/// Returns the header fields known before encoding: key and times.
wire::TileReplyT tile_fields(const RenderedTile& rendered);
/// Does all steps and returns the stored tile.
StoredTilePtr encode_tile(const RenderedTile& rendered, const ObjectDescription& object,
                          TileCodec codec);

}  // namespace mirage

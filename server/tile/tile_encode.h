#pragma once
// A rendered tile becomes a stored one: cut out of its page, measured, encoded. Pure functions.

#include "protocol/impostor/object_proxy.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// What the tile shows of the object, cut to its content, with its measured bounds.
Tile cut_and_measure(const RenderedTile& rendered, const ObjectDescription& object);
/// Of its header what is known before it is encoded: key and times.
wire::TileReplyT tile_fields(const RenderedTile& rendered);
/// All of it.
StoredTilePtr encode_tile(const RenderedTile& rendered, const ObjectDescription& object,
                          TileCodec codec);

}  // namespace mirage

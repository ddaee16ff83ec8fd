#pragma once
// The second layer of a layered tile, as rendered on its page.

#include <cstdint>
#include <vector>

#include "protocol/impostor/tile.h"

namespace mirage {

/// Fills Tile::behind and behind_depth from `packed`: 4 bytes a texel of the crop, as
/// resolve_layers.frag writes them.
void unpack_behind(const std::vector<std::uint8_t>& packed, Tile& tile);

/// Drops a second layer that is not worth its bytes, because too few visible texels hide something.
/// Its contribution to the view from the capture eye is merged into the front.
void drop_poor_layer(Tile& tile);

}  // namespace mirage

#pragma once
// The second layer of a layered tile, as it comes from its page.

#include <cstdint>
#include <vector>

#include "protocol/impostor/tile.h"

namespace mirage {

/// Into Tile::behind and behind_depth; `packed` as resolve_layers.frag writes it, 4 bytes a texel
/// of the crop.
void unpack_behind(const std::vector<std::uint8_t>& packed, Tile& tile);

/// Puts what the layer adds to the view from the capture into the front and empties it, unless it
/// is worth its bytes: of what shows, a share hides something.
void drop_poor_layer(Tile& tile);

}  // namespace mirage

#pragma once
// The id of a tile on this server: the first 128 bits of the SHA-256 of the whole canonical key. It
// covers the complete light, of which a TileKey has only a 64-bit hash. Clients choose the light.
// They could find two lights with equal 64-bit hashes and have one's tiles taken for the other's.

#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

/// Returns the id. A lit tile uses `lighting` (of the object), a shadow tile `world`; other tiles
/// use no light.
TileId tile_identity(const TileKey& key, const ObjectLighting& lighting, const Lighting& world);

}  // namespace mirage

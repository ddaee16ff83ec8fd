#pragma once
// The id of a tile on this server: SHA-256 of the whole canonical key, its first 128 bits. The
// light, of which a TileKey has 64 bits, is in it whole: clients choose it, and could find two that
// hash to the same 64 bits, one's tiles to be taken for the other's.

#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

/// `lighting`: of the object, of a lit tile; `world`: of a shadow tile; else without light.
TileId tile_identity(const TileKey& key, const ObjectLighting& lighting, const Lighting& world);

}  // namespace mirage

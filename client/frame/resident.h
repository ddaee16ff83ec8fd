#pragma once
// Handles of what is resident, for lists of what is drawn: whoever looks into one includes
// hold/tile_cache.h or hold/shadow_cache.h.

#include <cstdint>
#include <memory>

namespace mirage {

enum class DrawMethod : std::uint8_t { kQuad, kCuboid, kHull, kWarp, kDepth, kMesh };

struct TileRecord;
struct ShadowRecord;
/// Only the cache changes what it holds.
using TileRecordPtr = std::shared_ptr<const TileRecord>;
using ShadowRecordPtr = std::shared_ptr<ShadowRecord>;

}  // namespace mirage

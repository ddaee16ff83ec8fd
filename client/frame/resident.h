#pragma once
// Handles of resident tiles, for draw lists. Code that looks into a handle includes
// hold/tile_cache.h or hold/shadow_cache.h.

#include <cstdint>
#include <memory>

namespace mirage {

enum class DrawMethod : std::uint8_t { kQuad, kCuboid, kHull, kWarp, kDepth, kMesh };

struct TileRecord;
struct ShadowRecord;
/// Tiles are const, because only the cache changes them.
using TileRecordPtr = std::shared_ptr<const TileRecord>;
using ShadowRecordPtr = std::shared_ptr<ShadowRecord>;

}  // namespace mirage

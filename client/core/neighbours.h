#pragma once
// Which tiles of an object help each other: the one drawn, and those that saw what it did not.

#include <array>

#include "client/core/tile_cache.h"

namespace mirage {

/// Up to three tiles of the group to draw together from `view`: the nearest capture direction
/// first, then those within 35 degrees of the eye that lie on other sides of it; the rest null.
std::array<TileRecordPtr, 3> neighbours_for(const TileGroup& group, const ViewGeometry& view);

}  // namespace mirage

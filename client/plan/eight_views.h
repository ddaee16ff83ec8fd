#pragma once
// The classic baseline, for comparison only: an object is shown by the nearest of eight views baked
// around its horizon, flat, whatever the error is (Intel's forest of 2001, most engines since).

#include <optional>

#include "client/plan/tile_fit.h"
#include "client/plan/tile_need.h"

namespace mirage {

/// The tile captured nearest in direction, as a quad; of equally near ones the finest, then newest.
TileFit nearest_view(const TileGroup& group, const ObjectDescription& object,
                     const ViewGeometry& view);

/// The one of the eight views that is nearest, at 1.5 texels per pixel; nullopt when `group` has it
/// about as fine. `instance`, `light` and `gain` are left to the caller. `radius_px`: projected.
std::optional<TileNeed> eight_view_need(const TileGroup& group, const ViewGeometry& view,
                                        double radius_px);

}  // namespace mirage

#pragma once
// Eight views: the classic baseline, for comparison only. An object is shown by the nearest of
// eight views baked around its horizon, flat, however large the error is (Intel's forest of 2001,
// most engines since).

#include <optional>

#include "client/plan/tile_fit.h"
#include "client/plan/tile_need.h"

namespace mirage {

/// Returns the tile captured nearest in direction, drawn as a quad. Of equally near tiles it takes
/// the finest, then the newest.
TileFit nearest_view(const TileGroup& group, const ObjectDescription& object,
                     const ViewGeometry& view);

/// Returns the need for the nearest of the eight views, at 1.5 texels per pixel; nullopt if `group`
/// has it about as fine. The caller sets `instance`, `light` and `gain`. `radius_px` is the
/// projected radius.
std::optional<TileNeed> eight_view_need(const TileGroup& group, const ViewGeometry& view,
                                        double radius_px);

}  // namespace mirage

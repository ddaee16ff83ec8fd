#pragma once
// Motion needs: which poses of a moving object to ask for ahead of time (TECHNIQUES row 31).

#include <vector>

#include "client/hold/tile_cache.h"
#include "client/plan/selector_input.h"
#include "client/plan/tile_need.h"

namespace mirage {

/// Appends a need for each phase that `instance` will show between the arrival of a tile asked for
/// now and the horizon, unless a resident tile of that phase will do. `view` is the predicted view
/// at the present animation time; `tau_px` is the error that the instance may show.
void add_moving_needs(const SelectorInput& in, std::uint32_t instance, const ViewGeometry& view,
                      double tau_px, std::vector<TileNeed>& out);

}  // namespace mirage

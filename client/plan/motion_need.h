#pragma once
// Which poses of a moving object to ask for ahead of time (TECHNIQUES row 31).

#include <vector>

#include "client/hold/tile_cache.h"
#include "client/plan/selector.h"

namespace mirage {

/// Appends a need for each phase `instance` will show from the time a tile asked for now is here to
/// the horizon, unless a resident tile of that phase will do. `view` is the predicted one, at the
/// animation time of now; `tau_px` what the instance may be off.
void add_moving_needs(const SelectorInput& in, std::uint32_t instance, const ViewGeometry& view,
                      const TileCache::LitGroup& lit, double tau_px, std::vector<TileNeed>& out);

}  // namespace mirage

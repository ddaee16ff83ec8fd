#pragma once
// A drawn frame of the scene -> a view tile: colours as they are, depth and owners by cell.

#include "protocol/impostor/view_tile.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// Of a cell the nearest surface counts: what stands in front keeps its outline. A pure function.
ViewTile cut_view(const Camera& camera, const SceneFrame& frame);

}  // namespace mirage

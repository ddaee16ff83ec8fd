#pragma once
// Turns a drawn frame of the scene into a view tile: colours unchanged, depth and owners by cell.

#include "protocol/impostor/view_tile.h"
#include "server/tile/tile_job.h"

namespace mirage {

/// Makes a view tile. The nearest surface in a cell of texels counts, so things in front keep their
/// outline. A pure function.
ViewTile cut_view(const Camera& camera, const SceneFrame& frame);

}  // namespace mirage

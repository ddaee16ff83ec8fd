#pragma once
// Drawn tiles: real tiles with the pixels that were read back, in pages as the render stage makes
// them.

#include <memory>
#include <vector>

#include "protocol/base/result.h"
#include "server/tile/tile_job.h"

namespace mirage {
struct PreparedScene;
}

namespace mirage::bench {

/// Draws `count` tiles of the objects that have tiles of these channels. Errors: those of EGL and
/// of the tile renderer; kUsage: no object of the scene has such tiles.
Result<std::vector<RenderedTile>> draw_tiles(const std::shared_ptr<const PreparedScene>& scene,
                                             std::size_t count, std::uint32_t edge,
                                             std::uint8_t channels);

/// Draws these tiles, each of the given edge. Errors as above.
Result<std::vector<RenderedTile>> draw_jobs(const std::shared_ptr<const PreparedScene>& scene,
                                            const std::vector<TileJob>& jobs, std::uint32_t edge);

}  // namespace mirage::bench

#pragma once
#include "protocol/capture.h"
#include "protocol/object_proxy.h"
#include "protocol/tile.h"

namespace mirage {

/// Cuts a tile's content out of its page (crop with a margin of one empty texel where there is
/// room) and measures it: see TileMeasure. `rgba`/`depth`/`surface` point at the tile's lower left
/// texel in the page of `page_width` texels; rows go up, as GL reads them. Without `surface` the
/// tile is a lit one.
Tile cut_tile(const std::uint8_t* rgba, const std::uint8_t* depth, const std::uint8_t* surface,
              int page_width, const Capture& capture, const ObjectDescription& object);

}  // namespace mirage

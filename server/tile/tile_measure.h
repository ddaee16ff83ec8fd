#pragma once
#include "protocol/impostor/capture.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/impostor/tile.h"

namespace mirage {

/// A tile's pixels, from its lower left texel in a page of `width` texels; rows go up, as GL reads
/// them.
struct PageTexels {
  const std::uint8_t* rgba;
  const std::uint8_t* depth;  ///< for a shadow tile: the share of light left
  /// Relit tile: RGBA. Blended lit tile: R is the number of codes behind its depth that a texel
  /// still shows. Layered tile: the layer behind, packed as resolve_layers.frag does. Else null.
  const std::uint8_t* surface;
  int width;
};

/// Cuts a tile's content out of its page, with a margin of one empty texel if there is room, and
/// measures it (TileMeasure). Shadow and caster tiles have no measure.
Tile cut_tile(const PageTexels& page, std::uint8_t channels, const Capture& capture,
              const ObjectDescription& object);

}  // namespace mirage

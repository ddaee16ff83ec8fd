#pragma once
#include "protocol/impostor/capture.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/impostor/tile.h"

namespace mirage {

/// A tile's lower left texel in its page of `width` texels; rows go up, as GL reads them.
struct PageTexels {
  const std::uint8_t* rgba;
  const std::uint8_t* depth;  ///< of a shadow tile: what is left of its light
  /// Of a relit tile, RGBA; of a lit one that is blended, R: codes behind its depth that a texel
  /// still shows; of a layered one what is behind, packed as resolve_layers.frag does. Else null.
  const std::uint8_t* surface;
  int width;
};

/// Cuts a tile's content out of its page (crop with a margin of one empty texel where there is
/// room) and measures it: see TileMeasure. Shadow and caster tiles have no measure.
Tile cut_tile(const PageTexels& page, std::uint8_t channels, const Capture& capture,
              const ObjectDescription& object);

/// Capture depth at which the ray of each texel of `crop` enters the convex body of `planes`
/// (object space, normals outwards, the eye outside); NaN where it misses it. `center` is the
/// object's.
std::vector<float> entry_depths(const std::vector<Plane>& planes, const Capture& capture,
                                const glm::dvec3& center, const TileCrop& crop);

}  // namespace mirage

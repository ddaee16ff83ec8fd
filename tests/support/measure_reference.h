#pragma once
// Plain loops over every texel, to which the measure of a tile must be equal to the bit.

#include <vector>

#include "protocol/impostor/capture.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/impostor/tile.h"

namespace mirage::test {

/// Returns the largest dc^2 |1/z - 1/entry| over the texels that `codes` cover, or 100 times the
/// capture's distance if content lies where all rays around it miss the proxy.
float plain_difference(const std::vector<Plane>& planes, const Capture& capture,
                       const glm::dvec3& center, const TileCrop& crop,
                       const std::vector<std::uint8_t>& codes);

/// Returns the measure of a tile without its level's error. `behind`: TileMeasure::dz_behind's
/// codes; empty: nothing shows through.
TileMeasure plain_measure(const Tile& tile, const std::vector<std::uint8_t>& behind,
                          const Capture& capture, const ObjectDescription& object);

}  // namespace mirage::test

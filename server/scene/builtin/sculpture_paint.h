#pragma once
// Stone, metal, clay and wood for sculptures: tiling images, painted for one sculpture each.

#include <cstdint>

#include "protocol/model/model.h"

namespace mirage::builtin {

/// Maps that a finish does not use are empty.
struct SculptureFinish {
  Image color;
  Image metal_rough;
  Image normal;
  float roughness = 1;
  float metallic = 0;
};

inline constexpr std::uint32_t kFinishKinds = 9;

/// Paints finish number `kind` in the seed's colours, `side` pixels wide. If `with_normals`, relief
/// is painted as a normal map, which needs tangents that follow the texture coordinates.
SculptureFinish paint_finish(std::uint32_t kind, std::uint32_t seed, std::uint32_t side,
                             bool with_normals);

}  // namespace mirage::builtin

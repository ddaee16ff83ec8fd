#pragma once
// Stone, metal, clay and wood for sculptures: images that tile, painted for one sculpture each.

#include <cstdint>

#include "protocol/model/model.h"

namespace mirage::builtin {

/// Maps that a finish has no use for are empty.
struct SculptureFinish {
  Image color;
  Image metal_rough;
  Image normal;
  float roughness = 1;
  float metallic = 0;
};

inline constexpr std::uint32_t kFinishKinds = 9;

/// Finish number `kind` in colours of the seed's, `side` pixels wide. Relief is painted as a normal
/// map where `with_normals`: it takes the mesh to have the tangents of its texture coordinates.
SculptureFinish paint_finish(std::uint32_t kind, std::uint32_t seed, std::uint32_t side,
                             bool with_normals);

}  // namespace mirage::builtin

#pragma once
// Large glTF files made by code, for measuring how long loading takes.

#include <cstdint>
#include <string>

#include "protocol/base/result.h"

namespace mirage::test {

/// Bumpy balls side by side on a grid, each with smooth normals and a seam of texture coordinates.
/// Their sizes differ: the first has a fifth of all triangles.
struct LargeScene {
  std::uint64_t triangles = 600'000;  ///< approximately
  int meshes = 8;
  int copies = 1;           ///< of each mesh, at least 1
  int textures = 0;         ///< two thirds are colour as JPEG, the others normal maps as PNG
  int texture_edge = 2048;  ///< texels
};

/// Writes a .glb, with the same bytes every time. Returns their number. Error kIo.
Result<std::uint64_t> write_large_glb(const std::string& path, const LargeScene& scene);

}  // namespace mirage::test

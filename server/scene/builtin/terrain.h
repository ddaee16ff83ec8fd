#pragma once
// Square heightfields.

#include "server/scene/builtin/mesh_builder.h"

namespace mirage::builtin {

/// Adds a grid of `cells` x `cells` over [-half, half]^2. `height(x, z)` is in metres;
/// `color(position, normal)` is linear. uv runs 1 per `tile_m`.
template <typename Height, typename Color>
void add_terrain(MeshBuilder& builder, float half, int cells, float tile_m, Height height,
                 Color color) {
  const std::uint32_t first = builder.vertex_count();
  const float cell = 2 * half / static_cast<float>(cells);
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const float x = -half + cell * static_cast<float>(i);
      const float z = -half + cell * static_cast<float>(j);
      const float h = 0.5f;
      const glm::vec3 n = glm::normalize(glm::vec3(height(x - h, z) - height(x + h, z), 2 * h,
                                                   height(x, z - h) - height(x, z + h)));
      const glm::vec3 p(x, height(x, z), z);
      builder.paint(color(p, n));
      builder.vertex(p, n, glm::vec2(x, z) / tile_m);
    }
  }
  const auto row = static_cast<std::uint32_t>(cells + 1);
  for (std::uint32_t j = 0; j + 1 < row; ++j) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t k = first + j * row + i;
      builder.quad(k, k + row, k + row + 1, k + 1);
    }
  }
}

}  // namespace mirage::builtin

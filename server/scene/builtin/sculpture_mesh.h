#pragma once
// Meshes the two descriptions of a sculpture, with about as many triangles as asked for.

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>

#include "protocol/model/model.h"

namespace mirage::builtin {

/// A closed surface over the unit square. It closes on itself along u. Along v it also closes, or
/// its first and last row are points.
struct GridSurface {
  std::function<glm::vec3(float u, float v)> at;
  bool closes_along_v = false;
  float aspect = 1;  ///< cells along u for each one along v
  glm::vec2 texture_repeats{1};
};

/// A solid: its inside is where `distance` is below 0. `distance` may change at most 1.5 times as
/// fast as the true distance, so that empty space can be skipped.
struct Solid {
  std::function<float(glm::vec3)> distance;
  glm::vec3 half_extent{1};  ///< half the box about the origin that encloses it
  glm::vec2 texture_repeats{1};
};

/// Returns a mesh wound and facing outward, with tangents that follow its texture coordinates.
Mesh mesh_of(const GridSurface& surface, std::size_t triangles);
/// Returns a mesh by surface nets (Gibson 1998), with vertices moved onto the surface. Texture
/// coordinates run round the y axis and back, so they have no seam; the tangents do not follow
/// them.
Mesh mesh_of(const Solid& solid, std::size_t triangles);

}  // namespace mirage::builtin

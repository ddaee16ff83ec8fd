#pragma once
// Turns the two ways a sculpture is described by into a mesh of about as many triangles as asked.

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>

#include "protocol/model/model.h"

namespace mirage::builtin {

/// A closed surface over the unit square. It closes on itself along u; along v it does so, too, or
/// its first and last row are points.
struct GridSurface {
  std::function<glm::vec3(float u, float v)> at;
  bool closes_along_v = false;
  float aspect = 1;  ///< cells along u for each one along v
  glm::vec2 texture_repeats{1};
};

/// What is inside where `distance` is below 0. It must not change faster than the distance does by
/// more than a half, so that empty space can be skipped.
struct Solid {
  std::function<float(glm::vec3)> distance;
  glm::vec3 half_extent{1};  ///< of the box about the origin that it lies in
  glm::vec2 texture_repeats{1};
};

/// Wound and facing outward, with the tangents of its texture coordinates.
Mesh mesh_of(const GridSurface& surface, std::size_t triangles);
/// Surface nets (Gibson 1998), drawn to the surface. Texture coordinates run round the y axis and
/// back, so that they have no seam; the tangents are not theirs.
Mesh mesh_of(const Solid& solid, std::size_t triangles);

}  // namespace mirage::builtin

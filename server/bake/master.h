#pragma once
// The neutral form of a bake: what every target (engine) is exported from.

#include <glm/glm.hpp>
#include <vector>

#include "server/bake/lattice.h"

namespace mirage {

/// One object, captured orthographically from each vertex of a lattice. A frame spans `center` +-
/// `radius` each way exactly. Frame (i, j) has the number j * grid + i. Its texels follow those of
/// the frame before it: row by row, the top row (along the frame's up) first, then along its right.
struct BakeMaster {
  BakeLayout layout = BakeLayout::kHemi;
  RollRule roll;
  int grid = 0;                   ///< frames a side
  int tile = 0;                   ///< texels a side of a frame
  glm::dvec3 center{0};           ///< in the object's space
  double radius = 1;              ///< in the object's units
  std::vector<glm::vec4> color;   ///< premultiplied, linear, unshaded; alpha is the coverage
  std::vector<glm::vec3> normal;  ///< in the object's space, unit length; 0 where nothing is
  /// height of the nearest surface above the plane through the centre, toward the camera, in
  /// radii: -1 to 1; 0 where nothing is
  std::vector<float> depth;
  std::vector<glm::vec3> orm;  ///< occlusion, roughness, metallic; 1, 1, 0 where nothing is

  int frames() const { return grid * grid; }
  std::size_t texels() const { return std::size_t(frames()) * tile * tile; }
  /// Returns the number of the first texel of a frame.
  std::size_t first(int i, int j) const {
    return (std::size_t(j) * grid + i) * std::size_t(tile) * tile;
  }
  FrameBasis basis(int i, int j) const {
    return frame_basis(roll, frame_direction(layout, grid, i, j));
  }
  /// Sizes the planes for layout, grid and tile, empty.
  void clear() {
    color.assign(texels(), glm::vec4(0));
    normal.assign(texels(), glm::vec3(0));
    depth.assign(texels(), 0.0f);
    orm.assign(texels(), glm::vec3(1, 1, 0));
  }
};

}  // namespace mirage

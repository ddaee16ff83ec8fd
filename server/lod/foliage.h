#pragma once
// Foliage: primitives of many small pieces, of which coarser levels keep a share, enlarged.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "server/lod/lod_surface.h"

namespace mirage {

/// A connected component of foliage, with a frame of its own.
struct Piece {
  std::vector<std::uint32_t> triangles;
  glm::vec3 middle{0};
  /// Orthonormal, by column: along the piece, across it, and the rest.
  glm::mat3 axes{1};
  glm::vec3 half{0};  ///< largest distance from the middle along each axis
  double rank = 0;    ///< in [0, 1); pieces of the lowest ranks stay longest
};

/// Returns the components connected through equal positions, in the order of their first triangle.
std::vector<Piece> pieces_of(const Part& part);

/// True if the pieces are many and small, so that none is missed.
bool is_foliage(const Part& part, const std::vector<Piece>& pieces);

/// A share of the pieces, enlarged.
struct Thinned {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  float spread = 0;  ///< MeshLod::spread
};

/// Keeps the pieces with ranks below `share`, and enlarges them so that the covered area stays the
/// same (R. L. Cook et al., "Stochastic simplification of aggregate detail", 2007). A flat piece
/// first grows across, until it is as wide as long: a blade of grass gets broader, not longer.
Thinned thinned(const Part& part, const std::vector<Piece>& pieces, double share);

}  // namespace mirage

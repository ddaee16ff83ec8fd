#pragma once
// Normals of simplified surfaces.

#include "server/lod/lod_error.h"

namespace mirage {

/// A simplified surface on vertices of its own.
struct Level {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint32_t> origin;  ///< by vertex: its index in the full surface
  std::size_t copies = 0;             ///< of the vertices: the last, with normals of their own
};

/// The vertices that `indices` use, in order of first use.
Level level_of(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices);

/// Where a bevel has collapsed, the corner of a flat face keeps the normal of the bevel and shades
/// the whole face. Corners of triangles whose normals lead more than 10 degrees away from those of
/// the full surface beside them get a copy of the vertex, appended to `level.vertices`, with the
/// full surface's normal.
void restore_normals(const FullSurface& full, Level& level, const Workers& workers);

}  // namespace mirage

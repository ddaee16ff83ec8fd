#pragma once
// Normals of simplified surfaces.

#include "server/lod/lod_error.h"

namespace mirage {

/// A simplified surface on its own vertices.
struct Level {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint32_t> origin;  ///< by vertex: its index in the full surface
  std::size_t copies = 0;             ///< vertices that restore_normals() appended
};

/// Returns a level with the vertices that `indices` use, in order of first use.
Level level_of(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices);

/// Restores normals next to collapsed bevels. There, the corner of a flat face keeps the normal of
/// the bevel, which shades the whole face. A corner whose normal is more than 10 degrees off the
/// full surface beside it gets a copy of its vertex with the full surface's normal, appended to
/// `level.vertices`.
void restore_normals(const FullSurface& full, Level& level, const Workers& workers);

}  // namespace mirage

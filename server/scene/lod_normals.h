#pragma once
// Normals of simplified surfaces.

#include "server/scene/lod_error.h"

namespace mirage {

/// Where a bevel has collapsed, the corner of a flat face keeps the normal of the bevel and shades
/// the whole face. Corners of `indices` (triangles) whose normals lead more than 10 degrees away
/// from those of the full surface beside them get a copy of the vertex, appended to `vertices`,
/// with the full surface's normal. `vertices` come as those of the full surface.
void restore_normals(const FullSurface& full, std::vector<Vertex>& vertices,
                     std::vector<std::uint32_t>& indices, const Workers& workers);

}  // namespace mirage

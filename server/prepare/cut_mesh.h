#pragma once
// Parts of a large mesh, for an eye inside it or close to it. No picture of the whole mesh can show
// its surroundings there.

#include <vector>

#include "protocol/model/model.h"
#include "server/base/workers.h"

namespace mirage {

/// Largest number of parts of a mesh.
inline constexpr std::size_t kMostParts = 512;

/// Cuts `mesh` by halving the largest part where it is widest, until no part has more than an
/// eighth of the mesh's radius, or there are kMostParts. Before that, triangles with edges longer
/// than a quarter of a part's radius are divided at the middles of their edges, by the same rule on
/// both sides, so no gaps open.
///
/// A part also has the triangles next to it, so that its pictures overlap those of its neighbours.
/// Together the parts show what the mesh shows, with the same vertex data. A pure function. Returns
/// fewer than two parts if there is nothing to cut.
std::vector<Mesh> cut_mesh(const Mesh& mesh, const Workers& workers = Workers());

}  // namespace mirage

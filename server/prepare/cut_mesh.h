#pragma once
// Parts of a large mesh, for an eye that is inside of it or close to it, where no picture of the
// whole can stand for what is around.

#include <vector>

#include "protocol/model/model.h"
#include "server/base/workers.h"

namespace mirage {

/// At most this many parts a mesh.
inline constexpr std::size_t kMostParts = 512;

/// Cuts `mesh` by halving it where it is widest, the largest part first, until none has more than
/// an eighth of the mesh's radius or there are kMostParts. Triangles with longer edges than a
/// quarter of that are divided first: at the middles of their edges, by the same rule on both
/// sides, so that no gaps open. A part has the triangles next to it as well, so that its
/// neighbours' pictures overlap its own. Together the parts show what the mesh shows, and each is
/// of the same vertex data. A pure function. Fewer than two parts: there is nothing to cut.
std::vector<Mesh> cut_mesh(const Mesh& mesh, const Workers& workers = Workers());

}  // namespace mirage

#pragma once
// Convex hulls.

#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/object_proxy.h"
#include "server/base/workers.h"

namespace mirage {

/// A convex body of at most 26 faces that fully encloses the points (TECHNIQUES row 14): their
/// support planes in the 26 directions of a cube's faces, edges and corners, intersected. Grown by
/// a thousandth of the extent so that rounding leaves no point outside; flat point sets get that
/// thickness too. Its parallax factors are 0. Empty when there are no points. Error kInternal when
/// it has more than limits::kMaxHullVertices.
Result<ConvexHull> enclosing_hull(const std::vector<glm::vec3>& points);

/// Per hull vertex the distance to the nearest of `points` behind it, that is on the inner side of
/// the plane through the vertex across its direction from `center`. 0 where there is none.
std::vector<float> parallax_factors(const ConvexHull& hull, const std::vector<glm::vec3>& points,
                                    const glm::vec3& center, const Workers& workers = Workers());

}  // namespace mirage

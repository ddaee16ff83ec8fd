#pragma once
// Convex hulls.

#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/object_proxy.h"
#include "server/base/workers.h"

namespace mirage {

/// Returns a convex body of at most 26 faces that encloses all points (TECHNIQUES row 14). It is
/// the intersection of the support planes in the 26 directions of a cube's faces, edges and
/// corners. It is grown by a thousandth of the extent, so that rounding leaves no point outside;
/// flat point sets get that thickness too. Parallax factors are 0. Empty if there are no points.
/// Error kInternal: more than limits::kMaxHullVertices.
Result<ConvexHull> enclosing_hull(const std::vector<glm::vec3>& points);

/// Returns, for each hull vertex, the distance to the nearest of `points` behind it; 0 if there is
/// none. Behind means on the inner side of the plane through the vertex, perpendicular to its
/// direction from `center`.
std::vector<float> parallax_factors(const ConvexHull& hull, const std::vector<glm::vec3>& points,
                                    const glm::vec3& center, const Workers& workers = Workers());

}  // namespace mirage

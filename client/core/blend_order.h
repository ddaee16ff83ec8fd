#pragma once
// In which order soft fragments are blended: those of flat impostors write no depth, those of
// relief do, in one pass.

#include <vector>

#include "client/core/selector.h"

namespace mirage {

using DrawnImpostors = std::vector<const DrawnImpostor*>;

/// Flat impostors by when their soft fragments are blended; both keep the order of the list.
struct BlendOrder {
  DrawnImpostors under_relief;  ///< before relief is drawn, which may then lie over them
  DrawnImpostors over_relief;   ///< after: a cup on a desk that is relief
};

/// A flat impostor comes after relief when one that it overlaps on screen reaches farther back.
/// Spheres stand for the objects: a relief in front of it is then still told by its depth, all but
/// for its own soft edge.
BlendOrder blend_order(const std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye);

}  // namespace mirage

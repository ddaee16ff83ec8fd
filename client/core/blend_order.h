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

/// Where an impostor comes among what is blended, m from the eye; the larger, the sooner it is
/// drawn. The far side of an object's sphere, so that what stands on or in another thing comes
/// after it; of what is seen through the nearest content of its tile: what it contains comes before
/// it.
double blend_distance(const DrawnImpostor& drawn, const SceneView& scene, const glm::dvec3& eye);
/// Sorts by it, farthest first; equals keep their order, and tiles that fade into one another stay
/// together.
void sort_for_blending(std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye);

/// A flat impostor comes after relief when one that it overlaps on screen is blended before it.
/// Spheres stand for the objects: a relief in front of it is then still told by its depth, all but
/// for its own soft edge.
BlendOrder blend_order(const std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye);

}  // namespace mirage

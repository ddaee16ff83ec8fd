#pragma once
// In which order impostors are drawn: back to front, so that soft fragments lie over what is
// behind.

#include <vector>

#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"

namespace mirage {

/// Where an impostor comes among what is blended, m from the eye; the larger, the sooner it is
/// drawn. The far side of an object's sphere, so that what stands on or in another thing comes
/// after it; of what is seen through the nearest content of its tile: what it contains comes before
/// it.
double blend_distance(const DrawnImpostor& drawn, const SceneView& scene, const glm::dvec3& eye);
/// Sorts by it, farthest first; equals keep their order, and tiles that fade into one another stay
/// together.
void sort_for_blending(std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye);

}  // namespace mirage

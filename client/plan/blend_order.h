#pragma once
// Blend order: impostors are drawn back to front, so that soft fragments lie over what is behind.

#include <vector>

#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"

namespace mirage {

/// Returns the distance, m from the eye, by which an impostor is sorted; farther ones are drawn
/// first. It is the far side of the object's sphere, so that a thing standing on or in another one
/// is drawn after it. For an object with blended surfaces it is the nearest content of its tile, so
/// that the things inside are drawn before it.
double blend_distance(const DrawnImpostor& drawn, const SceneView& scene, const glm::dvec3& eye);
/// Sorts by blend_distance(), farthest first. Equals keep their order, and tiles that fade into one
/// another stay together.
void sort_for_blending(std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye);

}  // namespace mirage

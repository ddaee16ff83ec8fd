#pragma once
// Staging of a model that is looked at from outside: the points that its home view is to show, and
// the floor under it with its shadow.

#include "server/scene/gltf/bounds.h"
#include "server/scene/scene.h"

namespace mirage::gltf {

/// Returns the points of the scene within `frame` that are farthest out in each of
/// limits::kMaxFitPoints directions, relative to the frame's middle, each once.
std::vector<glm::vec3> outermost_points(const Scene& scene, const Bounds& frame);

/// Returns the floor at the lower end of `frame`, without a colour. Its shadow is darkest where the
/// scene touches it: a picture of nearness, not of a light.
StudioFloor floor_under(const Scene& scene, const Bounds& frame);

}  // namespace mirage::gltf

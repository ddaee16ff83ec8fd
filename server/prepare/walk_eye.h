#pragma once
// How high the eye of somebody is who walks in a scene, whatever the unit of its file.

#include <vector>

#include "protocol/impostor/object_proxy.h"
#include "server/scene/scene.h"

namespace mirage {

struct SceneBounds {
  glm::dvec3 center{0};
  double radius = 0;
};

/// Returns the height of a walker's eye over the ground, in units of the scene; 0: nobody walks
/// there, because the home view looks at the scene from outside, or nothing is below it.
///
/// A home view at the height of a person's eye says it; so does one under a ceiling. Elsewhere it
/// is 1.7 m in scenes of 3 m to 5 km, and that share of the scene in others.
double walk_eye(const Scene& scene, const std::vector<ObjectDescription>& objects,
                const SceneBounds& bounds);

}  // namespace mirage

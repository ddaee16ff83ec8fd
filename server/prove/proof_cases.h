#pragma once
// What the proof of leaving out (need_proof.h) draws: from where, in which light, which scene.

#include <memory>
#include <vector>

#include "protocol/model/scene_types.h"

namespace mirage {

struct PreparedScene;

/// Faces, corners, edges of a cube, 1 to 26: any first few of them are spread.
std::vector<glm::dvec3> proof_directions(int count);

struct ProofLighting {
  const char* name;
  Lighting lighting;
};

/// As the scene has it; with three lamps that are off; turned, with a lamp out of reach.
std::vector<ProofLighting> proof_lighting(const PreparedScene& scene);

/// The scene as it was imported. What blends with an alpha of 1 everywhere is what a renderer that
/// sorts shows: the depth buffer sorts it, with blending on.
std::shared_ptr<const PreparedScene> as_imported(const PreparedScene& scene);

}  // namespace mirage

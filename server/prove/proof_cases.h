#pragma once
// Cases for the proof of leaving out (need_proof.h): directions, lights, scenes.

#include <memory>
#include <vector>

#include "protocol/model/scene_types.h"

namespace mirage {

struct PreparedScene;

/// Returns directions through faces, corners, edges of a cube, 1 to 26. Any first few of them are
/// spread.
std::vector<glm::dvec3> proof_directions(int count);

struct ProofLighting {
  const char* name;
  Lighting lighting;
};

/// Returns three lightings: the scene's; with three black lamps; turned, with a lamp out of reach.
std::vector<ProofLighting> proof_lighting(const PreparedScene& scene);

/// Returns the scene as imported. A blended material with an alpha of 1 everywhere is drawn as a
/// sorting renderer shows it: sorted by the depth buffer, with blending on.
std::shared_ptr<const PreparedScene> as_imported(const PreparedScene& scene);

}  // namespace mirage

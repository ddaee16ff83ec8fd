#pragma once
// Patches: neighbouring triangles of a large mesh. The eye stands within a mesh that surrounds it,
// so that most of it is out of view; patches out of view are not drawn.

#include <glm/glm.hpp>
#include <vector>

#include "protocol/model/model.h"

namespace mirage {

struct Camera;
struct InstanceView;

struct Patch {
  IndexRun run;         ///< of one primitive
  glm::vec3 center{0};  ///< of a sphere around it, object units
  float radius = 0;
};

/// Cuts a mesh into patches, in the order of its indices. Reorders the triangles of its opaque
/// primitives. Returns nothing for a mesh of few triangles, which is not worth it.
std::vector<Patch> cut_into_patches(Mesh& mesh, const std::vector<Material>& materials);

/// Returns the runs of the patches that may be in view. Neighbours in the order of indices share a
/// run.
std::vector<IndexRun> runs_in_view(const std::vector<Patch>& patches, const InstanceView& instance,
                                   const Camera& camera);

}  // namespace mirage

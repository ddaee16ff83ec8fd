#pragma once
// Which groups a viewer needs the members of, nearest need first: what is told of a scene's tree.

#include <cstdint>
#include <vector>

#include "protocol/camera.h"
#include "server/scene/prepared_scene.h"

namespace mirage {

/// Who looks, and how much is told.
struct Opening {
  glm::dvec3 eye{0};
  glm::dvec3 forward{0, 0, -1};  ///< what lies before the eye comes first
  OpenRule rule;
  std::size_t least = 0;  ///< instances and groups that are told of beyond the rule, if there are
  std::size_t most = 1u << 16;  ///< told of at once; what is left over is asked for again
};

/// Of `groups` (numbered as instances) and what is nested in them, those whose members are needed,
/// a group before the ones in it.
std::vector<std::uint32_t> groups_to_open(const PreparedScene& scene,
                                          const std::vector<std::uint32_t>& groups,
                                          const Opening& opening);

}  // namespace mirage

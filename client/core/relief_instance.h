#pragma once
// What relief.vert and relief.frag are told of an impostor: per-instance attributes, and for merged
// ones a row of a float texture with up to three tiles.

#include <glm/glm.hpp>
#include <vector>

#include "client/core/selector.h"
#include "client/core/worn_shadow.h"

namespace mirage {

/// Attributes 2 to 11 and 13 to 15 of relief.vert.
struct ReliefInstance {
  glm::vec4 rotation, center_scale, right_distance, up_texels, window, place, range, slack, box_min,
      box_max;
  WornShadow shadow;
};
static_assert(sizeof(ReliefInstance) == 208);

inline constexpr int kReliefTiles = 3;
inline constexpr int kReliefTexelsPerTile = 8;
inline constexpr int kReliefRowTexels = kReliefTiles * kReliefTexelsPerTile;

/// `row` is the impostor's row of tile data; unused for one tile.
ReliefInstance relief_instance(const DrawnImpostor& drawn, const Camera& camera,
                               const SceneView& scene, int row);

/// kReliefRowTexels texels per merged impostor: per tile the columns of the map from object space
/// (relative to the centre) to tile space, the eye in it, the content's box with layer and weight.
void append_relief_row(const DrawnImpostor& drawn, const Camera& camera, const SceneView& scene,
                       std::vector<glm::vec4>& out);

}  // namespace mirage

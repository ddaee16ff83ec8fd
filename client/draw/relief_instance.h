#pragma once
// Relief instance: the per-instance attributes of relief.vert for an impostor.

#include <glm/glm.hpp>

#include "client/draw/worn_shadow.h"
#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"

namespace mirage {

/// Attributes 2 to 11 and 13 to 15 of relief.vert.
struct ReliefInstance {
  glm::vec4 rotation, center_scale, right_distance, up_texels, window, place, range, slack;
  glm::vec4 front, behind;  ///< for layered tiles
  WornShadow shadow;
};
static_assert(sizeof(ReliefInstance) == 208);

ReliefInstance relief_instance(const DrawnImpostor& drawn, const Camera& camera,
                               const SceneView& scene);

}  // namespace mirage

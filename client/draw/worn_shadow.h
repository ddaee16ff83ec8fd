#pragma once
// Worn shadow: the attributes of worn_shadow.glsl for the shadow tile that an impostor wears.

#include <glm/glm.hpp>

#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"

namespace mirage {

/// Attributes 13 to 15 of the impostor shaders.
struct WornShadow {
  glm::vec4 rotation{0, 0, 0, 1}, view{1, 0, 0, 0}, place{0, 0, 0, -1};
};
static_assert(sizeof(WornShadow) == 48);

/// Returns the attributes for points on the object's axes; with its rotation as `space`, on those
/// of the world.
WornShadow worn_shadow(const DrawnImpostor& drawn, const glm::quat& space = {1, 0, 0, 0});

/// Returns how much more full shadow takes from each colour than from luminance, because the sun's
/// share of the light differs between colours. It is exact on a surface that the sun meets at 60
/// degrees, and near enough elsewhere.
glm::vec3 shadow_tint(const Lighting& lighting);

}  // namespace mirage

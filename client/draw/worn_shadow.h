#pragma once
// What worn_shadow.glsl is told of the shadow tile an impostor wears.

#include <glm/glm.hpp>

#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"

namespace mirage {

/// Attributes 13 to 15 of the impostor shaders.
struct WornShadow {
  glm::vec4 rotation{0, 0, 0, 1}, view{1, 0, 0, 0}, place{0, 0, 0, -1};
};
static_assert(sizeof(WornShadow) == 48);

/// For points in the object's axes or, with its rotation as `space`, in those of the world.
WornShadow worn_shadow(const DrawnImpostor& drawn, const glm::quat& space = {1, 0, 0, 0});

/// By how much more than luminance full shadow takes from each colour: the sun's share of the light
/// differs between them. Exact on a surface that the sun meets at 60 degrees, near enough
/// elsewhere.
glm::vec3 shadow_tint(const Lighting& lighting);

}  // namespace mirage

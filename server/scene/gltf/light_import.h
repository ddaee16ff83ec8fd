#pragma once
// KHR_lights_punctual -> Lighting, with one exposure for all lights of the scene.

#include "protocol/model/scene_types.h"
#include "server/scene/gltf/bounds.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/node_import.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// The lights of the drawn nodes, or a default ambient and key light where there are none.
/// glTF's lux and candela are divided by pi, so that albedo * color * cos (over the squared
/// distance) is the radiance of a Lambert surface. If together they would overexpose the middle
/// of `bounds`, all are scaled alike and a warning says by how much.
/// `own`: whether there were any.
Lighting import_lighting(const Document& document, const NodeTree& tree, const Bounds& bounds,
                         Tally& tally, bool& own);

}  // namespace mirage::gltf

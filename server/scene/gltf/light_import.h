#pragma once
// Turns KHR_lights_punctual into Lighting, with one exposure for all lights of the scene.

#include "protocol/model/scene_types.h"
#include "server/scene/gltf/bounds.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/node_import.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// Returns the lights of the drawn nodes, or a default ambient and key light if there are none.
/// glTF's lux and candela are divided by pi, so that albedo * color * cos (over the squared
/// distance) is the radiance of a Lambert surface. If all lights together would overexpose the
/// middle of `bounds`, they are scaled alike, and a warning gives the factor. `own`: true if the
/// file has lights.
Lighting import_lighting(const Document& document, const NodeTree& tree, const Bounds& bounds,
                         Tally& tally, bool& own);

}  // namespace mirage::gltf

#pragma once
// The home view of an imported scene.

#include <cstddef>

#include "protocol/model/scene_types.h"
#include "server/scene/gltf/bounds.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/node_import.h"

namespace mirage::gltf {

/// Returns the first perspective camera of the file if it is near the scene. Otherwise returns a
/// view from outside that shows everything; it is nearer for flat scenes of many instances
/// (streets, forests).
HomeView import_home_view(const Document& document, const NodeTree& tree, const Bounds& bounds,
                          std::size_t instances);

/// True if that view is one from outside, for which the file has no camera.
bool is_seen_from_outside(const Document& document, const NodeTree& tree, const Bounds& bounds,
                          std::size_t instances);

}  // namespace mirage::gltf

#pragma once
// Where a viewer of an imported scene starts.

#include <cstddef>

#include "protocol/model/scene_types.h"
#include "server/scene/gltf/bounds.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/node_import.h"

namespace mirage::gltf {

/// The first perspective camera of the file if it stands near the scene, else a view from outside
/// that holds all of it; nearer for flat scenes of many instances (streets, forests).
HomeView import_home_view(const Document& document, const NodeTree& tree, const Bounds& bounds,
                          std::size_t instances);

}  // namespace mirage::gltf

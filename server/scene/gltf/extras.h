#pragma once
// Mirage's own data in a file: `extras.mirage` of its elements, read from the JSON because the
// typed model has no extras.

#include <map>
#include <nlohmann/json_fwd.hpp>

#include "protocol/model/scene_types.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// Returns the value at `key`; nullptr if `object` is no object or lacks the key.
const nlohmann::json* member(const nlohmann::json& object, const char* key);
/// Returns `extras.mirage.key` of a node, mesh or other element; nullptr if absent.
const nlohmann::json* mirage_extra(const nlohmann::json& element, const char* key);

/// Elements with an `extras.mirage.importance`, by index.
struct ImportanceMarks {
  std::map<int, Importance> of_node, of_mesh;
};

/// Reads "scenery" and "important"; other values are ignored with a warning.
ImportanceMarks read_importance(const nlohmann::json& root, Tally& tally);

}  // namespace mirage::gltf

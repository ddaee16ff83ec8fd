#pragma once
// What a file says for us alone: `extras.mirage` of its elements, read from the JSON by hand, as
// the typed model has no extras.

#include <map>
#include <nlohmann/json_fwd.hpp>

#include "protocol/model/scene_types.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// The value at `key`; nullptr when `object` is no object or has none.
const nlohmann::json* member(const nlohmann::json& object, const char* key);
/// `extras.mirage.key` of a node, mesh or the like; nullptr when absent.
const nlohmann::json* mirage_extra(const nlohmann::json& element, const char* key);

/// Where `extras.mirage.importance` is given, by index.
struct ImportanceMarks {
  std::map<int, Importance> of_node, of_mesh;
};

/// Takes "scenery" and "important"; anything else is ignored, with a warning.
ImportanceMarks read_importance(const nlohmann::json& root, Tally& tally);

}  // namespace mirage::gltf

#include "server/scene/gltf/extras.h"

#include <nlohmann/json.hpp>

namespace mirage::gltf {
namespace {

using nlohmann::json;

std::map<int, Importance> read_marks(const json& root, const char* list_name, Tally& tally) {
  std::map<int, Importance> out;
  const json* list = member(root, list_name);
  if (list == nullptr || !list->is_array()) return out;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const json* mark = mirage_extra((*list)[i], "importance");
    if (mark == nullptr) continue;
    if (*mark == "scenery") {
      out[static_cast<int>(i)] = Importance::kScenery;
    } else if (*mark == "important") {
      out[static_cast<int>(i)] = Importance::kImportant;
    } else {
      tally.add("extras.mirage.importance other than \"scenery\" or \"important\" ignored", 1,
                std::string(list_name) + "[" + std::to_string(i) + "]");
    }
  }
  return out;
}

}  // namespace

const json* member(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

const json* mirage_extra(const json& element, const char* key) {
  const json* extras = member(element, "extras");
  const json* ours = extras != nullptr ? member(*extras, "mirage") : nullptr;
  return ours != nullptr ? member(*ours, key) : nullptr;
}

ImportanceMarks read_importance(const json& root, Tally& tally) {
  return {read_marks(root, "nodes", tally), read_marks(root, "meshes", tally)};
}

}  // namespace mirage::gltf

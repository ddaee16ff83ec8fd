#include "server/scene/gltf/json_extensions.h"

#include <algorithm>
#include <vector>

#include "modules/ktx2_library.h"
#include "server/scene/gltf/name_list.h"

namespace mirage::gltf {
namespace {

using nlohmann::json;

constexpr char kVariants[] = "KHR_materials_variants";
constexpr char kBasisu[] = "KHR_texture_basisu";

const json* extension(const json& object, const char* name) {
  const auto list = object.find("extensions");
  if (list == object.end()) return nullptr;
  const auto found = list->find(name);
  return found == list->end() ? nullptr : &*found;
}

/// Returns the material of a primitive in a variant; nullptr: it keeps its own.
const json* material_of(const json& primitive, std::size_t variant) {
  const json* source = extension(primitive, kVariants);
  if (source == nullptr) return nullptr;
  for (const json& mapping : (*source)["mappings"]) {
    for (const json& index : mapping["variants"]) {
      if (index.get<std::size_t>() == variant) return &mapping["material"];
    }
  }
  return nullptr;
}

Result<std::vector<std::string>> variant_names(const json& root, Tally& tally) {
  std::vector<std::string> names;
  const json* source = extension(root, kVariants);
  if (source == nullptr) return names;
  for (const json& variant : (*source)["variants"]) {
    std::string name = variant.value("name", std::string());
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      auto ok = tally.forgive(
          "variants of one name, the first is taken",
          make_error(ErrorId::kSceneFormat, "two variants named '" + shown_name(name) + "'"));
      if (!ok) return ok.error();
    }
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace

Result<std::vector<std::string>> choose_variant(json& root, const std::string& variant,
                                                Tally& tally) {
  auto names = variant_names(root, tally);
  if (!names || variant.empty()) return names;
  const auto found = std::find(names->begin(), names->end(), variant);
  if (found == names->end()) {
    return make_error(ErrorId::kUsage, "no variant '" + shown_name(variant) + "'",
                      listed_names("variants", *names));
  }
  const auto index = static_cast<std::size_t>(found - names->begin());
  const auto meshes = root.find("meshes");
  if (meshes == root.end()) return names;
  for (json& mesh : *meshes) {
    for (json& primitive : mesh["primitives"]) {
      const json* material = material_of(primitive, index);
      if (material != nullptr) primitive["material"] = json(*material);
    }
  }
  return names;
}

Result<void> settle_basisu(json& root, const std::string& path, Tally& tally) {
  const auto textures = root.find("textures");
  if (textures == root.end()) return {};
  for (std::size_t i = 0; i < textures->size(); ++i) {
    json& texture = (*textures)[i];
    const json* basisu = extension(texture, kBasisu);
    if (basisu == nullptr) continue;
    const std::string name = "textures[" + std::to_string(i) + "]";
    if (texture.contains("source") || extension(texture, "EXT_texture_webp") != nullptr) {
      tally.add("textures of KHR_texture_basisu use their fallback", 1, name);
    } else if (!ktx2_library()) {
      return make_error(ErrorId::kSceneExtension,
                        name +
                            " is of KHR_texture_basisu, which this build does not read, without "
                            "a fallback",
                        "npx @gltf-transform/cli ktxdecompress '" + path + "' OUT.glb");
    } else if (basisu->contains("source")) {
      texture["source"] = json(basisu->at("source"));
    }
  }
  return {};
}

}  // namespace mirage::gltf

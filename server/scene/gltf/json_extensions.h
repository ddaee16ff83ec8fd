#pragma once
// Extensions that are resolved in the sanitised JSON, before tinygltf. Later stages do not see
// them.

#include <nlohmann/json.hpp>
#include <string>

#include "protocol/base/result.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// KHR_materials_variants: gives each primitive the material of this variant; empty: the file's
/// initial ones. Among variants of the same name, the first is used. Returns the names of all
/// variants. Errors: kUsage (no such variant; the hint lists them).
Result<std::vector<std::string>> choose_variant(nlohmann::json& root, const std::string& variant,
                                                Tally& tally);

/// KHR_texture_basisu: makes textures use their fallback. Errors: kSceneExtension (a texture has
/// none; the hint is the command that converts the file).
Result<void> settle_basisu(nlohmann::json& root, const std::string& path, Tally& tally);

}  // namespace mirage::gltf

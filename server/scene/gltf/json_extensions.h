#pragma once
// Extensions that are settled in the sanitised JSON, before tinygltf: what comes after does not
// know of them.

#include <nlohmann/json.hpp>
#include <string>

#include "protocol/base/result.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// KHR_materials_variants: gives each primitive the material of this variant; empty: as the file
/// has it. Of variants of one name the first is taken. Errors: kUsage (no such variant; the hint
/// lists what there is).
Result<void> choose_variant(nlohmann::json& root, const std::string& variant, Tally& tally);

/// KHR_texture_basisu: textures use their fallback. Errors: kSceneExtension (one has none; the hint
/// is the command that converts the file).
Result<void> settle_basisu(nlohmann::json& root, const std::string& path, Tally& tally);

}  // namespace mirage::gltf

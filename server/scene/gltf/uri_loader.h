#pragma once
// Loads the bytes behind a glTF URI: only a data URI, or a regular file inside the scene's folder.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/result.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// Decodes `data:[type][;base64],…` strictly. Errors: kSceneUri.
Result<std::vector<std::uint8_t>> decode_data_uri(std::string_view uri);

/// Returns the file that a relative URI names. Refuses schemes, absolute paths and everything that
/// leaves `folder`, also through symbolic links. Forgives ".." that stays inside, backslashes,
/// spaces and broken escapes. Errors: kSceneUri.
Result<std::filesystem::path> resolve_uri(std::string_view uri, const std::filesystem::path& folder,
                                          Tally& tally);

/// Loads either of the above as a whole. `what` ("buffers[0]") begins the error text.
Result<std::vector<std::uint8_t>> load_uri(std::string_view uri,
                                           const std::filesystem::path& folder,
                                           std::uint64_t max_bytes, const std::string& what,
                                           Tally& tally);

}  // namespace mirage::gltf

#pragma once
// The first checks of a file, on raw bytes: container and sizes are checked before any
// parser sees them.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/result.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

struct SceneLimits;

/// A glTF container split into its parts; the views point into `bytes`.
struct GltfFile {
  std::vector<std::uint8_t> bytes;
  std::string_view json;
  std::span<const std::uint8_t> bin;
  bool has_bin = false;
  std::optional<Error> lengths_off;  ///< forgiven, as long as all that the JSON names is there
};

/// Reads a whole regular file. Errors: kSceneMissing (absent or unreadable), `not_regular` for a
/// directory, device or pipe, kSceneLimit beyond `max_bytes`; their texts do not name the file.
Result<std::vector<std::uint8_t>> read_regular_file(const std::filesystem::path& path,
                                                    std::uint64_t max_bytes, ErrorId not_regular);

/// Reads and splits a .glb or .gltf file; its bytes decide which it is. Error kSceneLimit: larger
/// than `limits` allow.
Result<GltfFile> open_gltf(const std::string& path, const SceneLimits& limits, Tally& tally);

/// Splits bytes that are already read. Lengths in a GLB that are off are forgiven. Errors:
/// kSceneFormat.
Result<GltfFile> split_container(std::vector<std::uint8_t> bytes, Tally& tally);

}  // namespace mirage::gltf

#pragma once
// The first checks of a file, on raw bytes: container, sizes and nesting are checked before any
// parser sees them.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::gltf {

/// A glTF container split into its parts; the views point into `bytes`.
struct GltfFile {
  std::vector<std::uint8_t> bytes;
  std::string_view json;
  std::span<const std::uint8_t> bin;
  bool has_bin = false;
};

/// Reads a whole regular file. Errors: kSceneMissing (absent or unreadable), `not_regular` for a
/// directory, device or pipe, kSceneLimit beyond `max_bytes`; their texts do not name the file.
Result<std::vector<std::uint8_t>> read_regular_file(const std::filesystem::path& path,
                                                    std::uint64_t max_bytes, ErrorId not_regular);

/// Reads and splits a .glb or .gltf file; its bytes decide which it is.
Result<GltfFile> open_gltf(const std::string& path);

/// Splits bytes that are already read. Errors: kSceneFormat.
Result<GltfFile> split_container(std::vector<std::uint8_t> bytes);

/// Checks nesting depth and number of values without recursion. Returns the number of objects that
/// name a property twice (names compared by their bytes). Errors: kSceneLimit.
Result<std::uint64_t> scan_json(std::string_view text);

}  // namespace mirage::gltf

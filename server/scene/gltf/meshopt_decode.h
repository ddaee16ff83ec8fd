#pragma once
// EXT_meshopt_compression: decodes one compressed bufferView into plain bytes, through
// meshoptimizer.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::gltf {

enum class MeshoptMode { kAttributes, kTriangles, kIndices };
enum class MeshoptFilter { kNone, kOctahedral, kQuaternion, kExponential };

struct MeshoptView {
  MeshoptMode mode = MeshoptMode::kAttributes;
  MeshoptFilter filter = MeshoptFilter::kNone;
  std::uint32_t count = 0;   ///< elements
  std::uint32_t stride = 0;  ///< bytes of one element, decoded

  std::uint64_t decoded_bytes() const { return std::uint64_t{count} * stride; }
};

/// Returns a view from the names of the extension ("ATTRIBUTES", "OCTAHEDRAL"). Errors:
/// kSceneFormat; kSceneExtension for filters of KHR_meshopt_compression that meshoptimizer 0.18
/// lacks.
Result<MeshoptView> meshopt_view(std::string_view mode, std::string_view filter,
                                 std::uint32_t count, std::uint32_t stride);

/// Decodes exactly decoded_bytes(), and checks the sizes before it allocates. Index values are not
/// checked. Any thread. Errors: kSceneFormat (impossible sizes, broken data), kSceneLimit,
/// kSceneExtension (a later version of the bitstream).
Result<std::vector<std::uint8_t>> decode_meshopt(std::span<const std::uint8_t> bytes,
                                                 const MeshoptView& view);

}  // namespace mirage::gltf

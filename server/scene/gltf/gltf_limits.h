#pragma once
// Limits of a file. Counts are judged before memory for them is taken.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "protocol/base/result.h"

namespace mirage::gltf {

/// Counts that follow the memory that a scene may take (`--scene-mb`).
struct SceneLimits {
  std::uint64_t megabytes = 0;
  std::uint64_t file_bytes = 0;           ///< the file with all its buffers
  std::uint64_t json_bytes = 0;           ///< with data URIs
  std::uint64_t json_values = 0;          ///< outside of extras
  std::uint64_t elements = 0;             ///< nodes, and of each other list
  std::uint64_t primitives = 0;           ///< in the file, and in the scene
  std::uint64_t vertices = 0;             ///< over all objects
  std::uint64_t indices = 0;              ///< over all objects
  std::uint64_t draco_faces = 0;          ///< of one mesh
  std::uint64_t draco_faces_in_file = 0;  ///< over all meshes
  std::uint64_t draco_bytes = 0;          ///< attributes of one mesh, decoded
  std::uint64_t decoded_pixels = 0;       ///< all images before reducing
  std::uint64_t whole_pixels = 0;         ///< of one image that decoders hold as a whole

  /// Returns the error of a count beyond one of these limits; it says which budget has room.
  /// `what`: the noun, in the plural. `helps`: the arguments of gltf-transform that make a smaller
  /// file.
  Error exceeded(std::uint64_t count, std::uint64_t limit, std::string_view what,
                 std::string_view helps = "simplify IN OUT") const;
  /// Returns the error where counting stopped at the limit.
  Error exceeded_at_least(std::uint64_t count, std::uint64_t limit, std::string_view what,
                          std::string_view helps = "simplify IN OUT") const;
};

/// Returns what a scene of so many megabytes may hold. Measured at the most that the server took
/// while it drew, with a renderer whose buffers lie in the same memory: 300 to 360 bytes a vertex
/// of points, 170 bytes a value in JSON.
SceneLimits limits_within(std::uint64_t megabytes);

inline constexpr int kMaxJsonDepth = 64;
inline constexpr std::uint64_t kMaxInstances = 1'000'000;
inline constexpr std::uint64_t kMaxZeroElements = 1'000'000;  ///< in accessors without a bufferView
inline constexpr std::uint64_t kMaxMeshoptBytes = 1ull << 31;  ///< of one bufferView, decoded
inline constexpr std::uint64_t kMaxImageFileBytes = 512ull << 20;
inline constexpr std::size_t kMaxClips = 10'000;
inline constexpr std::size_t kMaxChannelsInFile = 100'000;  ///< of one clip
inline constexpr double kMaxClipOffset = 1e6;               ///< s
inline constexpr std::size_t kMaxLights = 256;
inline constexpr std::uint32_t kMaxImageSide = 16384;
inline constexpr std::uint64_t kMaxImagePixels = 64ull << 20;   ///< one image
inline constexpr std::uint64_t kMaxScenePixels = 128ull << 20;  ///< all images, 4 bytes each

/// Vertices beyond this count as not finite. A mesh keeps its shape at any scale, but float
/// positions need some room above it.
inline constexpr float kMaxPosition = 1e36f;
/// Limit for positions of moving objects: the squares of their differences, and sums of a few of
/// them, must stay inside float (3.4e38).
inline constexpr float kMaxCoordinate = 1e18f;
/// Texture coordinates beyond this have no fraction left in float.
inline constexpr float kMaxTextureCoordinate = 1e9f;

}  // namespace mirage::gltf

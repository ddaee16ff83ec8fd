#pragma once
// Caps that keep the load of any file, hostile ones included, below about 1 GB and 5 s.

#include <cstddef>
#include <cstdint>

namespace mirage::gltf {

inline constexpr std::uint64_t kMaxFileBytes = 512ull << 20;  ///< the file, and all its buffers
inline constexpr std::uint64_t kMaxJsonBytes = 256ull << 20;  ///< mostly data URIs at that size
inline constexpr std::uint64_t kMaxJsonValues = 6'000'000;    ///< bounds the parsed tree
inline constexpr int kMaxJsonDepth = 64;                      ///< parsers recurse per level
inline constexpr std::size_t kMaxNodes = 500'000;
inline constexpr std::uint64_t kMaxInstances = 1'000'000;
inline constexpr std::size_t kMaxPrimitives = 200'000;    ///< in the file, and in the scene
inline constexpr std::uint64_t kMaxVertices = 8'000'000;  ///< over all objects, 64 bytes each
inline constexpr std::uint64_t kMaxIndices = 60'000'000;  ///< over all objects
inline constexpr std::uint32_t kMaxDracoFaces =
    6'600'000;  ///< of one mesh: 90 bytes each, decoding
inline constexpr std::uint64_t kMaxDracoFacesInFile = 12'000'000;       ///< 5 million a second
inline constexpr std::uint64_t kMaxDracoAttributeBytes = 256ull << 20;  ///< of one mesh
inline constexpr std::uint64_t kMaxZeroElements = 1'000'000;  ///< accessors without a bufferView
inline constexpr std::size_t kMaxClips = 10'000;
inline constexpr std::size_t kMaxChannelsInFile = 100'000;  ///< of one clip
inline constexpr double kMaxClipOffset = 1e6;               ///< s
inline constexpr std::size_t kMaxLights = 256;
inline constexpr std::uint32_t kMaxImageSide = 16384;
inline constexpr std::uint64_t kMaxImagePixels = 64ull << 20;     ///< one image
inline constexpr std::uint64_t kMaxScenePixels = 128ull << 20;    ///< all images, 4 bytes each
inline constexpr std::uint64_t kMaxDecodedPixels = 512ull << 20;  ///< of them before reducing

/// Vertices beyond this are treated as not finite: a mesh keeps its shape at any scale, but its
/// place in a float world needs some room above it.
inline constexpr float kMaxPosition = 1e36f;
/// Of what moves, positions beyond this are: the squares of their differences, and sums of
/// a few of those, must stay inside float (3.4e38).
inline constexpr float kMaxCoordinate = 1e18f;
/// Texture coordinates beyond this have no fraction left in float.
inline constexpr float kMaxTextureCoordinate = 1e9f;

}  // namespace mirage::gltf

#pragma once
// Caps that keep loading any file, even a hostile one, below about 1 GB and 5 s.

#include <cstddef>
#include <cstdint>

namespace mirage::gltf {

inline constexpr std::uint64_t kMaxFileBytes = 512ull << 20;  ///< the file with all its buffers
inline constexpr std::uint64_t kMaxJsonBytes = 256ull << 20;  ///< at that size, mostly data URIs
inline constexpr std::uint64_t kMaxJsonValues = 6'000'000;    ///< limits the parsed tree
inline constexpr int kMaxJsonDepth = 64;                      ///< parsers recurse once per level
inline constexpr std::size_t kMaxNodes = 500'000;
inline constexpr std::uint64_t kMaxInstances = 1'000'000;
inline constexpr std::size_t kMaxPrimitives = 200'000;    ///< in the file, and in the scene
inline constexpr std::uint64_t kMaxVertices = 8'000'000;  ///< over all objects, 64 bytes each
inline constexpr std::uint64_t kMaxIndices = 60'000'000;  ///< over all objects
inline constexpr std::uint32_t kMaxDracoFaces =
    6'600'000;  ///< in one mesh: 90 bytes each while decoding
inline constexpr std::uint64_t kMaxDracoFacesInFile = 12'000'000;       ///< 5 million a second
inline constexpr std::uint64_t kMaxDracoAttributeBytes = 256ull << 20;  ///< of one mesh
inline constexpr std::uint64_t kMaxZeroElements = 1'000'000;  ///< in accessors without a bufferView
inline constexpr std::size_t kMaxClips = 10'000;
inline constexpr std::size_t kMaxChannelsInFile = 100'000;  ///< of one clip
inline constexpr double kMaxClipOffset = 1e6;               ///< s
inline constexpr std::size_t kMaxLights = 256;
inline constexpr std::uint32_t kMaxImageSide = 16384;
inline constexpr std::uint64_t kMaxImagePixels = 64ull << 20;     ///< one image
inline constexpr std::uint64_t kMaxScenePixels = 128ull << 20;    ///< all images, 4 bytes each
inline constexpr std::uint64_t kMaxDecodedPixels = 512ull << 20;  ///< all images before reducing

/// Vertices beyond this count as not finite. A mesh keeps its shape at any scale, but float
/// positions need some room above it.
inline constexpr float kMaxPosition = 1e36f;
/// Limit for positions of moving objects: the squares of their differences, and sums of a few of
/// them, must stay inside float (3.4e38).
inline constexpr float kMaxCoordinate = 1e18f;
/// Texture coordinates beyond this have no fraction left in float.
inline constexpr float kMaxTextureCoordinate = 1e9f;

}  // namespace mirage::gltf

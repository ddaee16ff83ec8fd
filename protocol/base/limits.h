#pragma once
// All bounds on what a peer may send or ask for. Decoders check them before they allocate. Units
// are in the names.

#include <cstddef>
#include <cstdint>

namespace mirage::limits {

inline constexpr std::uint32_t kProtocolVersion = 5;

// Wire.
inline constexpr std::size_t kMaxMessageBytes = 256 * 1024;           ///< one WebSocket message
inline constexpr std::size_t kMaxControlBytes = 224 * 1024;           ///< its FlatBuffer part
inline constexpr std::size_t kMaxTransferBytes = 256u * 1024 * 1024;  ///< a chunked message, whole
inline constexpr std::size_t kMaxInboundTransferBytes =
    1024 * 1024;  ///< from client to server, whole
inline constexpr std::size_t kMaxOpenTransfers = 4;
inline constexpr std::size_t kChunkBytes = 128 * 1024;
inline constexpr std::size_t kMaxTextBytes = 4096;
inline constexpr std::size_t kMaxFitPoints = 64;     ///< of a home view
inline constexpr std::size_t kMaxChoices = 256;      ///< clips, and variants, that a scene offers
inline constexpr std::size_t kMaxChoiceBytes = 256;  ///< of the name of one
inline constexpr std::size_t kMaxObjectNameBytes = 64;
inline constexpr std::size_t kFrozenPerPage = 4096;  ///< tiles, and assets, in a catalogue's page
inline constexpr std::size_t kMaxFrozen = 1u << 20;  ///< files that a frozen folder tells of
inline constexpr std::size_t kMaxCodecs = 32;        ///< in one list of codecs

// Requests.
inline constexpr std::size_t kMaxAsksPerBatch = 1024;
inline constexpr std::size_t kMaxCancelsPerBatch = 4096;
inline constexpr std::size_t kMaxQueuedAsksPerClient = 4096;
inline constexpr std::size_t kMaxLightingStatesPerClient = 64;
/// Memory for the full renders of all clients that are rendering or waiting to be sent. One of the
/// largest size fits.
inline constexpr std::size_t kMaxFullRenderBytes = 512u << 20;
constexpr std::size_t reference_bytes(std::uint32_t width, std::uint32_t height) {
  return std::size_t{12} * width * height;  // colour, depth, id
}
inline constexpr std::size_t kMaxReferencePixels = 4096u * 4096u;
inline constexpr std::uint32_t kMaxReferenceEdge = 8192;
inline constexpr std::uint32_t kMaxReferenceSupersample = 4;  ///< per axis
/// True if a full render of this size is allowed; `supersample` is per axis.
constexpr bool reference_within_limits(std::uint32_t width, std::uint32_t height,
                                       std::uint32_t supersample) {
  const bool edges =
      width >= 1 && width <= kMaxReferenceEdge && height >= 1 && height <= kMaxReferenceEdge;
  const bool samples = supersample >= 1 && supersample <= kMaxReferenceSupersample;
  return edges && samples &&
         std::uint64_t{width} * height * supersample * supersample <= 2 * kMaxReferencePixels;
}
inline constexpr std::uint32_t kMinViewEdge = 16;
inline constexpr std::uint32_t kMaxViewEdge = 1024;
inline constexpr std::size_t kMaxViewTexels = 640u * 360u;
inline constexpr std::size_t kMaxViewInstances = 4096;  ///< told apart by id in one view

// Scene description.
inline constexpr std::size_t kMaxObjects = 1u << 20;
inline constexpr std::size_t kMaxInstances = 1u << 21;
inline constexpr std::size_t kInstancesPerPage = 1536;  ///< of instances, and of groups
inline constexpr std::size_t kMaxOpensPerRequest = 8192;
inline constexpr std::uint32_t kMaxGroupDepth =
    64;  ///< depth of nested groups; a few million leaves take 10
inline constexpr std::size_t kObjectsPerPage = 48;
inline constexpr std::size_t kMaxImages = 1u << 16;
inline constexpr std::size_t kImagesPerPage = 4096;
inline constexpr std::size_t kMaxHullVertices = 128;
inline constexpr std::size_t kMaxHullTriangles = 256;
inline constexpr std::size_t kMaxLights = 16;

// Tiles.
inline constexpr int kMaxViewLevel = 16;      ///< 2^16 x 2^16 octahedral cells
inline constexpr int kMaxDistanceLevel = 16;  ///< 2^16 buckets per octave
inline constexpr int kMaxSizeClass = 14;
inline constexpr std::uint32_t kMaxTileEdge = 2048;
/// Below this distance (in radii) no impostor is generated; see numerics.md section 2.
inline constexpr double kMinCaptureRadii = 1.2;
inline constexpr double kMaxCaptureRadii = 1.0e6;

// Geometry.
inline constexpr std::size_t kMaxMeshVertices = 4u << 20;
inline constexpr std::size_t kMaxMeshIndices = 24u << 20;
inline constexpr std::size_t kMaxMeshPrimitives = 4096;
inline constexpr std::size_t kMaxLods = 8;  ///< including the full mesh
inline constexpr std::size_t kMaxImageEdge = 16384;

// Animation of an object.
inline constexpr int kMaxPhaseLevel = 8;  ///< 2^8 phases a clip
inline constexpr std::size_t kMotionSegments = 64;
inline constexpr std::size_t kTrackSteps = 256;  ///< straight parts of the way of an object
inline constexpr double kMaxClipSeconds = 1e6;   ///< keys are floats: steps of 0.06 s there
inline constexpr std::size_t kMaxJoints = 1024;
inline constexpr std::size_t kMaxBindings = 8192;
inline constexpr std::size_t kMaxChannels = 4096;
inline constexpr std::size_t kMaxMorphSets = 1024;
inline constexpr std::size_t kMaxMorphTargets = 1024;         ///< of one set of targets
inline constexpr std::size_t kMaxMorphDeltas = 8u << 20;      ///< over all targets
inline constexpr std::size_t kMaxAnimationFloats = 4u << 20;  ///< times and values, all channels
inline constexpr std::size_t kMaxBentVertices = 1u
                                                << 18;  ///< of several joints, or in morph targets

// View parameters.
inline constexpr double kMinFovDegrees = 0.01;
inline constexpr double kMaxFovDegrees = 170.0;

}  // namespace mirage::limits

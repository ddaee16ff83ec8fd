#pragma once
// KHR_draco_mesh_compression: one compressed mesh -> plain arrays, through libdraco.
//
// The bytes are hostile until proven otherwise: libdraco allocates by the counts it reads, so those
// are read and judged here first, and the size of the attributes once the connectivity is known.

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::gltf {

/// Whether this build has libdraco.
bool has_draco();

struct DracoAttribute {
  std::uint32_t unique_id = 0;  ///< as the extension's `attributes` say
  int component_type = 0;       ///< wanted: 5120..5126
  std::size_t components = 0;   ///< wanted: 1..4
};

struct DracoMesh {
  std::uint32_t points = 0;
  std::vector<std::uint32_t> indices;                 ///< triangles, all below `points`
  std::vector<std::vector<std::uint8_t>> attributes;  ///< as wanted, tightly packed
};

/// The number of triangles that a Draco bitstream of version 2.2 or later claims.
/// Errors: kSceneFormat (no such bitstream), kSceneLimit.
Result<std::uint32_t> peek_draco_faces(std::span<const std::uint8_t> bytes);

/// Decodes a mesh and converts its attributes to the types wanted: integers stay as they are,
/// what becomes float is normalised where the bitstream says so. Any thread.
/// Errors: kSceneFormat (broken, or without a wanted attribute), kSceneLimit, kSceneExtension
/// (built without libdraco).
Result<DracoMesh> decode_draco(std::span<const std::uint8_t> bytes,
                               std::span<const DracoAttribute> wanted);

}  // namespace mirage::gltf

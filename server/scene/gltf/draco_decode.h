#pragma once
// KHR_draco_mesh_compression: decodes one compressed mesh into plain arrays through libdraco.
//
// The bytes are treated as hostile. libdraco allocates by the counts it reads, so these are read
// and checked here first. The size of the attributes is checked once the connectivity is known.

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::gltf {

struct SceneLimits;

/// True if this build has libdraco.
bool has_draco();

struct DracoAttribute {
  std::uint32_t unique_id = 0;  ///< value in the extension's `attributes`
  int component_type = 0;       ///< requested: 5120..5126
  std::size_t components = 0;   ///< requested: 1..4
};

struct DracoMesh {
  std::uint32_t points = 0;
  std::vector<std::uint32_t> indices;                 ///< triangles, all below `points`
  std::vector<std::vector<std::uint8_t>> attributes;  ///< in the requested order, tightly packed
};

/// Returns the number of triangles that a Draco bitstream of version 2.2 or later claims. Errors:
/// kSceneFormat (no such bitstream), kSceneLimit.
Result<std::uint32_t> peek_draco_faces(std::span<const std::uint8_t> bytes,
                                       const SceneLimits& limits);

/// Decodes a mesh and converts its attributes to the requested types. Integers keep their values;
/// values that become float are normalised if the bitstream says so. Any thread. Errors:
/// kSceneFormat (broken, or without a requested attribute), kSceneLimit, kSceneExtension (built
/// without libdraco).
Result<DracoMesh> decode_draco(std::span<const std::uint8_t> bytes,
                               std::span<const DracoAttribute> wanted, const SceneLimits& limits);

}  // namespace mirage::gltf

#pragma once
// Turns a glTF mesh in one pose into a Mesh, within the budget of the scene.

#include <cstdint>

#include "protocol/base/result.h"
#include "protocol/model/model.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/material_import.h"
#include "server/scene/gltf/primitive_read.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

/// Limits on all meshes of a scene together.
class Budget {
 public:
  explicit Budget(const SceneLimits& limits) : limits_(limits) {}
  /// Takes the amounts. Error kSceneLimit names the limit that they would exceed.
  Result<void> take(std::uint64_t vertices, std::uint64_t indices);
  /// Counts kept primitives; it limits scenes of very many tiny meshes.
  Result<void> take_primitives(std::uint64_t count);
  void give_back(std::uint64_t vertices, std::uint64_t indices);

 private:
  const SceneLimits& limits_;
  std::uint64_t vertices_ = 0;
  std::uint64_t indices_ = 0;
  std::uint64_t primitives_ = 0;
};

/// The origin of a vertex in the file.
struct VertexOrigin {
  std::uint32_t primitive = 0;
  std::uint32_t vertex = 0;
};

/// Imports a mesh, which may be empty. `origins`, if given, gets one entry per vertex. Errors:
/// those of read_primitive, and kSceneLimit.
Result<Mesh> import_mesh(const Document& document, int mesh, const Pose& pose,
                         MaterialImporter& materials, Budget& budget, Tally& tally,
                         std::vector<VertexOrigin>* origins = nullptr);

}  // namespace mirage::gltf

#pragma once
// Levels of detail of an object, as tiles are drawn from them and as replies carry them.

#include "protocol/base/bytes.h"
#include "protocol/codec/model_codec.h"
#include "protocol/model/model.h"
#include "server/base/workers.h"

namespace mirage {

class LodFamilies;
struct ObjectDescription;
struct Scene;
struct SceneObject;

/// One level of an object as a reply carries it.
struct EncodedLod {
  Bytes payload;
  std::uint32_t raw_bytes = 0;  ///< once decompressed; the payload's size when it is not compressed
};

/// Geometry of one object below the whole mesh, and all of it encoded.
struct ObjectGeometry {
  /// By level; level 0, which is the object's own mesh, is empty. Tiles are never drawn from
  /// thinned foliage, as it has no bound; views are.
  std::vector<Mesh> tile_lods;
  std::vector<EncodedLod> encoded;
};

/// `mesh` with only the materials it uses.
ObjectModel object_model(const Scene& scene, const Mesh& mesh);

/// Levels of detail of `object`, made and encoded; `description.lods` is filled in. `families`: of
/// the scene; nullptr: none shares levels.
ObjectGeometry make_geometry(const Scene& scene, const SceneObject& object,
                             ObjectDescription& description, const LodFamilies* families = nullptr,
                             const Workers& workers = Workers());

}  // namespace mirage

#pragma once
// Levels of detail of an object, in the forms for drawing tiles and for replies.

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
  std::uint32_t raw_bytes = 0;  ///< decompressed size; equal to the payload's if uncompressed
};

/// The coarser levels of one object, and all its levels encoded.
struct ObjectGeometry {
  /// Coarser meshes, indexed by level. Level 0 is empty, as it is the object's own mesh. Tiles are
  /// never drawn from thinned foliage, because that has no bound; views are.
  std::vector<Mesh> tile_lods;
  std::vector<EncodedLod> encoded;
};

/// Returns `mesh` with only the materials it uses.
ObjectModel object_model(const Scene& scene, const Mesh& mesh);

/// Makes and encodes the levels of detail of `object`, and fills in `description.lods`. `families`:
/// those of the scene; nullptr: no levels are shared.
ObjectGeometry make_geometry(const Scene& scene, const SceneObject& object,
                             ObjectDescription& description, const LodFamilies* families = nullptr,
                             const Workers& workers = Workers());

}  // namespace mirage

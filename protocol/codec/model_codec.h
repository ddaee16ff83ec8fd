#pragma once
// One level of an object's geometry on the wire: quantised vertices and indices in meshoptimizer's
// encodings, with the materials it uses. Images travel apart (image_codec.h).

#include <memory>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/model/animation.h"
#include "protocol/model/model.h"

namespace mirage {

/// primitive.material indexes `materials`; texture images index the scene's image list.
struct ObjectModel {
  Mesh mesh;
  std::vector<Material> materials;
  std::shared_ptr<const Animation> animation;  ///< set: the mesh is in bind space
};

/// The same of a mesh that lies elsewhere and is not to be copied.
struct ModelView {
  const Mesh& mesh;
  const std::vector<Primitive>& primitives;  ///< the mesh's, with its materials as below
  const std::vector<Material>& materials;
  const Animation* animation = nullptr;
};

/// Positions become 16 bits a coordinate over the mesh's box, normals and tangents octahedral of 10
/// bits a component, texture coordinates 16 bits over their range, colours 8 bits a channel (square
/// roots of linear light, so that dark ones stay apart). Tangents travel only where a material maps
/// normals, coordinates only where one reads them, colours only where one is not white. Equal
/// vertices are joined, unused ones dropped; triangles are reordered within opaque primitives only.
/// Order of primitives: triangles first. Misuse (an index out of range) ends the program.
Bytes encode_model(const ModelView& model);
inline Bytes encode_model(const ObjectModel& model) {
  return encode_model(
      ModelView{model.mesh, model.mesh.primitives, model.materials, model.animation.get()});
}
/// Every count is checked against limits.h and the bytes that are there before allocating, every
/// index against its array (images: `image_count`), every float for being finite. Errors:
/// kWireMalformed, kWireLimit, kWireValue.
Result<ObjectModel> decode_model(const std::uint8_t* bytes, std::size_t size,
                                 std::size_t image_count);

/// Largest distance by which quantising moves a vertex of a mesh with this box, object units.
double quantisation_error(const glm::vec3& box_min, const glm::vec3& box_max);

/// Fixed layout without padding, also used where materials are hashed.
Bytes encode_materials(const std::vector<Material>& materials);

}  // namespace mirage

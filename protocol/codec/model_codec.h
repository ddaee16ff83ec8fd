#pragma once
// One level of an object's geometry on the wire: quantised vertices and indices in meshoptimizer's
// encodings, with the materials it uses. Images travel separately (image_codec.h).

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

/// A model whose mesh is stored elsewhere and is not copied.
struct ModelView {
  const Mesh& mesh;
  const std::vector<Primitive>& primitives;  ///< the mesh's, with its materials as below
  const std::vector<Material>& materials;
  const Animation* animation = nullptr;
};

/// Encodes a model. Positions take 16 bits a coordinate over the mesh's box. Normals and tangents
/// are octahedral with 10 bits a component. Texture coordinates take 16 bits over their range.
/// Colours take 8 bits a channel as square roots of linear light, so that dark ones stay apart.
///
/// Tangents travel only if a material maps normals, coordinates only if a material reads them,
/// colours only if one is not white. Equal vertices are joined and unused ones dropped. Triangles
/// are reordered within opaque primitives only. Primitives of triangles come first. Misuse (an
/// index out of range) ends the program.
Bytes encode_model(const ModelView& model);
inline Bytes encode_model(const ObjectModel& model) {
  return encode_model(
      ModelView{model.mesh, model.mesh.primitives, model.materials, model.animation.get()});
}
/// Decodes a model. Every count is checked against limits.h and the bytes present before
/// allocating, every index against its array (images: `image_count`), every float for being finite.
/// Errors: kWireMalformed, kWireLimit, kWireValue.
Result<ObjectModel> decode_model(const std::uint8_t* bytes, std::size_t size,
                                 std::size_t image_count);

/// Returns the largest distance that quantising moves a vertex of a mesh with this box, object
/// units.
double quantisation_error(const glm::vec3& box_min, const glm::vec3& box_max);

/// Returns materials in a fixed layout without padding. Hashes of materials use these bytes, too.
Bytes encode_materials(const std::vector<Material>& materials);

}  // namespace mirage

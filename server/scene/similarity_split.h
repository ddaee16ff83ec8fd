#pragma once
// world_from_object as a similarity times a residual that is baked into the mesh, so that the
// error bound only ever meets rotations, translations and one scale.

#include <glm/glm.hpp>

#include "protocol/model/model.h"
#include "protocol/model/scene_types.h"

namespace mirage {

/// matrix = similarity * residual; the longest column of `residual` is about 1.
struct SplitTransform {
  Similarity similarity;
  glm::dmat3 residual{1};
  bool has_residual = false;
};

/// Polar decomposition of a finite matrix: rotation, largest column length as scale, and what is
/// left (shear, non-uniform scale, mirroring; a flattening keeps all of its linear part here).
SplitTransform split_transform(const glm::dmat4& matrix);

/// Applies a residual to a mesh: normals by the cofactor matrix, winding and bitangents turned
/// where it mirrors. Singular residuals give finite, flat meshes.
Mesh bake(const Mesh& mesh, const glm::dmat3& residual);

/// Turns every triangle round.
void swap_winding(Mesh& mesh);

}  // namespace mirage

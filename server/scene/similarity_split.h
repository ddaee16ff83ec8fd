#pragma once
// Splits world_from_object into a similarity and a residual that is baked into the mesh. The error
// bound then only meets rotations, translations and one scale.

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

/// Polar decomposition of a finite matrix into a rotation, a scale (the largest column length) and
/// a residual: shear, non-uniform scale, mirroring. The residual of a flattening keeps its whole
/// linear part.
SplitTransform split_transform(const glm::dmat4& matrix);

/// Applies a residual to a mesh. Normals use the cofactor matrix; winding and bitangents turn if it
/// mirrors. Singular residuals give finite, flat meshes.
Mesh bake(const Mesh& mesh, const glm::dmat3& residual);

/// Reverses the winding of every triangle.
void swap_winding(Mesh& mesh);

}  // namespace mirage

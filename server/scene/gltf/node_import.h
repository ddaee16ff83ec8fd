#pragma once
// The node hierarchy: checked to be a forest, then flattened to world matrices in double precision.

#include <glm/glm.hpp>
#include <vector>

#include "protocol/base/result.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

struct NodeTree {
  std::vector<glm::dmat4> world_from_node;  ///< of every node in the file; may hold inf or NaN
  std::vector<int> drawn;                   ///< nodes of the active scene, parents first
  std::vector<int> parent;                  ///< of every node, -1: none
  std::vector<int> order;                   ///< every node, parents first
};

/// Flattens without recursion: a chain of 100 000 nodes is valid. Makes the children of the model a
/// forest: each node stays below the parent that lists it first. Errors when strict: kSceneCycle (a
/// node below itself, or with two parents), kSceneReference (a scene lists a node that has a
/// parent).
Result<NodeTree> flatten_nodes(tinygltf::Model& model, Tally& tally);

/// Returns parent_from_node at rest.
glm::dmat4 local_matrix(const tinygltf::Node& node, Tally& tally);

bool is_finite(const glm::dmat4& matrix);

/// Returns the matrix of a glTF transform. The quaternion is (x, y, z, w); one without length
/// counts as no rotation.
glm::dmat4 matrix_from_trs(const glm::dvec3& translation, const glm::dvec4& rotation,
                           const glm::dvec3& scale, Tally& tally);

}  // namespace mirage::gltf

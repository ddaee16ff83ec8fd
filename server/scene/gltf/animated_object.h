#pragma once
// Turns a group of moving mesh nodes into one mesh in bind space with one animation.

#include <memory>
#include <optional>

#include "protocol/model/scene_types.h"
#include "server/scene/gltf/mesh_import.h"
#include "server/scene/gltf/motion_groups.h"

namespace mirage::gltf {

struct AnimatedObject {
  std::string name;
  Mesh mesh;
  std::shared_ptr<const Animation> animation;
  Similarity world_from_object;
};

/// Inputs for building a group.
struct GroupInput {
  const Document& document;
  const NodeTree& tree;
  const MotionGroups& motion;
  const std::map<int, NodeClip>& clips;
  int group = 0;           ///< as in MotionGroups::group
  std::vector<int> nodes;  ///< mesh nodes of the group
};

/// Builds a group. Rigid parts are bound to their node with weight 1, skinned ones to up to four
/// joints (the heaviest four of more). Morph targets are kept as the vertices they move. nullopt,
/// with a warning: the animation exceeds limits.h or has poses that are not finite, and the nodes
/// must be imported at rest. Errors: those of import_mesh.
Result<std::optional<AnimatedObject>> build_animated(const GroupInput& input,
                                                     MaterialImporter& materials, Budget& budget,
                                                     Tally& tally);

}  // namespace mirage::gltf

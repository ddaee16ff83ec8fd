#pragma once
// One group of moving mesh nodes -> one mesh in bind space with one animation.

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

/// What a group is made from.
struct GroupInput {
  const Document& document;
  const NodeTree& tree;
  const MotionGroups& motion;
  const std::map<int, NodeClip>& clips;
  int group = 0;           ///< as in MotionGroups::group
  std::vector<int> nodes;  ///< its mesh nodes
};

/// Rigid parts are bound to their node with weight 1, skinned ones to up to four joints (the
/// heaviest four of more), morph targets kept as the vertices they move. nullopt, with a warning,
/// where the animation cannot be kept (limits.h, or poses that are not finite): the nodes are then
/// to be imported at rest. Errors: those of import_mesh.
Result<std::optional<AnimatedObject>> build_animated(const GroupInput& input,
                                                     MaterialImporter& materials, Budget& budget,
                                                     Tally& tally);

}  // namespace mirage::gltf

#pragma once
// Which nodes move, and which of them belong together: everything below one animated subtree or
// one skeleton becomes one object.

#include <map>
#include <vector>

#include "server/scene/gltf/clip_import.h"
#include "server/scene/gltf/node_import.h"

namespace mirage::gltf {

struct MotionGroups {
  std::vector<bool> moves;  ///< per node: it, or a node above it, has keys
  /// Per drawn mesh node that moves, is bent by moving joints, or has moving morph weights: its
  /// group, named by a node all transforms above which stand still; -1 for everything else.
  std::vector<int> group;
};

MotionGroups find_motion(const Document& document, const NodeTree& tree,
                         const std::map<int, NodeClip>& clips);

}  // namespace mirage::gltf

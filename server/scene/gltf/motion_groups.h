#pragma once
// Finds the moving nodes and groups them: everything below one animated subtree or one skeleton
// becomes one object.

#include <map>
#include <vector>

#include "server/scene/gltf/clip_import.h"
#include "server/scene/gltf/node_import.h"

namespace mirage::gltf {

struct MotionGroups {
  std::vector<bool> moves;  ///< by node: it or a node above has keys
  /// Group of each drawn mesh node that moves, is bent by moving joints, or has moving morph
  /// weights; -1 for other nodes. The number of a group is that of a node with no moving transform
  /// above it.
  std::vector<int> group;
};

MotionGroups find_motion(const Document& document, const NodeTree& tree,
                         const std::map<int, NodeClip>& clips);

}  // namespace mirage::gltf

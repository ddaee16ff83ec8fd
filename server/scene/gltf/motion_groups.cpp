#include "server/scene/gltf/motion_groups.h"

#include <algorithm>

namespace mirage::gltf {
namespace {

constexpr int kNoGroup = -1;

}  // namespace

MotionGroups find_motion(const Document& document, const NodeTree& tree,
                         const std::map<int, NodeClip>& clips) {
  const tinygltf::Model& model = document.model;
  MotionGroups out;
  out.moves.assign(model.nodes.size(), false);
  out.group.assign(model.nodes.size(), kNoGroup);
  if (clips.empty()) return out;
  std::vector<bool> marked(model.nodes.size(), false);
  for (const auto& [node, clip] : clips) marked[node] = !clip.channels.empty();
  for (const int node : tree.order) {
    const int above = tree.parent[node];
    out.moves[node] = marked[node] || (above != kNoGroup && out.moves[above]);
  }
  std::vector<bool> skin_moves(model.skins.size(), false);
  for (std::size_t s = 0; s < model.skins.size(); ++s) {
    const std::vector<int>& joints = model.skins[s].joints;
    skin_moves[s] = std::any_of(joints.begin(), joints.end(), [&](int j) { return out.moves[j]; });
    if (!skin_moves[s]) continue;
    for (const int joint : joints) marked[joint] = true;
  }
  // The highest marked node above is the root, so a skeleton and the things attached to it stay
  // together.
  std::vector<int> root(model.nodes.size(), kNoGroup);
  for (const int node : tree.order) {
    const int above = tree.parent[node];
    root[node] = above != kNoGroup && root[above] != kNoGroup ? root[above]
                 : marked[node]                               ? node
                                                              : kNoGroup;
  }
  for (const int node : tree.drawn) {
    const tinygltf::Node& source = model.nodes[node];
    if (source.mesh < 0) continue;
    const auto clip = clips.find(node);
    const bool morphs = clip != clips.end() && !clip->second.weights.empty();
    const bool bends = source.skin >= 0 && skin_moves[source.skin];
    if (bends) {
      out.group[node] = root[model.skins[source.skin].joints.front()];
    } else if (out.moves[node] || morphs) {
      out.group[node] = root[node] != kNoGroup ? root[node] : node;
    }
  }
  return out;
}

}  // namespace mirage::gltf

#include "server/scene/gltf/node_import.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <iterator>
#include <string>

namespace mirage::gltf {
namespace {

constexpr int kNoParent = -1;
constexpr std::size_t kShownPath = 8;
constexpr int kMostListedAgain = 16;

std::string node_name(int node) { return "nodes[" + std::to_string(node) + "]"; }

/// Returns the parent of each node. A child that is listed again, or by itself, stays where it is
/// listed first. A file with many of them means copies, which glTF does not know.
Result<std::vector<int>> find_parents(tinygltf::Model& model, Tally& tally) {
  std::vector<int> parent(model.nodes.size(), kNoParent);
  int again = 0;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const int self = static_cast<int>(i);
    std::vector<int> kept;
    for (const int child : model.nodes[i].children) {
      std::string why;
      if (child == self) {
        why = node_name(self) + " is its own child";
      } else if (parent[child] == self) {
        why = node_name(self) + " lists its child " + node_name(child) + " twice";
      } else if (parent[child] != kNoParent) {
        why = node_name(child) + " has two parents, " + node_name(parent[child]) + " and " +
              node_name(self);
      } else {
        parent[child] = self;
        kept.push_back(child);
        continue;
      }
      const Error error = make_error(ErrorId::kSceneCycle, why);
      if (++again > kMostListedAgain) return error;
      if (auto ok = tally.lose("children listed again left out", error); !ok) return ok.error();
    }
    model.nodes[i].children = std::move(kept);
  }
  return parent;
}

/// Returns the loop on or below which `node` is, as "nodes[2] > nodes[0] > nodes[2]".
std::string cycle_path(const std::vector<int>& parent, int node) {
  // The walk takes as many steps up as there are nodes, so it is surely on the loop itself.
  for (std::size_t i = 0; i < parent.size(); ++i) node = parent[node];
  std::string path = node_name(node);
  int at = parent[node];
  for (std::size_t i = 1; at != node && i < kShownPath; ++i, at = parent[at]) {
    path = node_name(at) + " > " + path;
  }
  return (at == node ? node_name(at) : std::string("...")) + " > " + path;
}

/// Leaves out nodes below themselves: no root leads to them.
Result<void> leave_out_loops(tinygltf::Model& model, const std::vector<bool>& reached,
                             std::vector<int>& parent, Tally& tally) {
  const auto first = std::find(reached.begin(), reached.end(), false);
  if (first == reached.end()) return {};
  const auto node = static_cast<int>(first - reached.begin());
  auto ok = tally.lose(
      "loops of nodes left out",
      make_error(ErrorId::kSceneCycle, "a node lies below itself: " + cycle_path(parent, node)));
  if (!ok) return ok;
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (reached[i]) continue;
    parent[i] = kNoParent;
    model.nodes[i].children.clear();
    model.nodes[i].mesh = -1;
  }
  return {};
}

/// Returns the nodes from the roots down. Each has one parent, so unreached nodes are on a loop or
/// below one.
Result<std::vector<int>> order_nodes(tinygltf::Model& model, std::vector<int>& parent,
                                     Tally& tally) {
  std::vector<int> order;
  std::vector<bool> reached(parent.size(), false);
  order.reserve(parent.size());
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (parent[i] == kNoParent) order.push_back(static_cast<int>(i));
  }
  for (std::size_t at = 0; at < order.size(); ++at) {
    reached[order[at]] = true;
    const auto& children = model.nodes[order[at]].children;
    order.insert(order.end(), children.begin(), children.end());
  }
  if (auto ok = leave_out_loops(model, reached, parent, tally); !ok) return ok.error();
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (!reached[i]) order.push_back(static_cast<int>(i));
  }
  return order;
}

/// Removes the nodes below another node of the list, which are drawn with it.
std::vector<int> topmost(const std::vector<int>& listed, const std::vector<int>& parent,
                         const std::vector<int>& order) {
  std::vector<bool> covered(parent.size(), false);  // listed, or below a listed node
  for (const int node : listed) covered[node] = true;
  std::vector<bool> below(parent.size(), false);
  for (const int node : order) {
    if (parent[node] == kNoParent || !covered[parent[node]]) continue;
    covered[node] = below[node] = true;
  }
  std::vector<int> roots;
  for (const int node : listed) {
    if (!below[node]) roots.push_back(node);
  }
  return roots;
}

/// Returns the roots of the active scene: `scene`, else the first one; without scenes, all roots. A
/// listed child is drawn once, at the place its parents give it. Viewers differ if those parents
/// move: three.js removes the child from its parent, Babylon refuses the file. Files that do this
/// have parents at rest.
Result<std::vector<int>> scene_roots(const tinygltf::Model& model, const std::vector<int>& parent,
                                     const std::vector<int>& order, Tally& tally) {
  std::vector<int> roots;
  if (model.scenes.empty()) {
    for (std::size_t i = 0; i < parent.size(); ++i) {
      if (parent[i] == kNoParent) roots.push_back(static_cast<int>(i));
    }
    return roots;
  }
  const int scene = model.defaultScene < 0 ? 0 : model.defaultScene;
  std::vector<bool> listed(parent.size(), false);
  for (const int node : model.scenes[scene].nodes) {
    if (parent[node] != kNoParent) {
      auto ok = tally.forgive(
          "scenes' entries that are children of other nodes drawn once",
          make_error(ErrorId::kSceneReference, "scenes[" + std::to_string(scene) + "] lists " +
                                                   node_name(node) + ", which is a child of " +
                                                   node_name(parent[node])));
      if (!ok) return ok.error();
    }
    if (listed[node]) {
      auto ok = tally.forgive(
          "nodes that a scene lists twice drawn once",
          make_error(ErrorId::kSceneReference,
                     "scenes[" + std::to_string(scene) + "] lists " + node_name(node) + " twice"));
      if (!ok) return ok.error();
      continue;
    }
    roots.push_back(node);
    listed[node] = true;
  }
  return topmost(roots, parent, order);
}

/// True unless KHR_node_visibility hides the node.
bool is_visible(const tinygltf::Node& node) {
  const auto found = node.extensions.find("KHR_node_visibility");
  if (found == node.extensions.end() || !found->second.Has("visible")) return true;
  const tinygltf::Value& visible = found->second.Get("visible");
  return !visible.IsBool() || visible.Get<bool>();
}

}  // namespace

Result<NodeTree> flatten_nodes(tinygltf::Model& model, Tally& tally) {
  auto parent = find_parents(model, tally);
  if (!parent) return parent.error();
  auto order = order_nodes(model, *parent, tally);
  if (!order) return order.error();
  auto roots = scene_roots(model, *parent, *order, tally);
  if (!roots) return roots.error();

  NodeTree tree;
  tree.world_from_node.assign(model.nodes.size(), glm::dmat4(1));
  for (const int node : *order) {
    const glm::dmat4 local = local_matrix(model.nodes[node], tally);
    const int above = (*parent)[node];
    tree.world_from_node[node] = above == kNoParent ? local : tree.world_from_node[above] * local;
  }
  // A hidden node hides all below it.
  const auto add_visible = [&](const std::vector<int>& nodes) {
    std::copy_if(nodes.begin(), nodes.end(), std::back_inserter(tree.drawn),
                 [&](int node) { return is_visible(model.nodes[node]); });
  };
  add_visible(*roots);
  for (std::size_t at = 0; at < tree.drawn.size(); ++at) {
    add_visible(model.nodes[tree.drawn[at]].children);
  }
  tree.parent = parent.take();
  tree.order = order.take();
  return tree;
}

glm::dmat4 local_matrix(const tinygltf::Node& node, Tally& tally) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dvec3 translation(0);
  glm::dvec4 rotation(0, 0, 0, 1);
  glm::dvec3 scale(1);
  if (node.translation.size() == 3) translation = glm::make_vec3(node.translation.data());
  if (node.rotation.size() == 4) rotation = glm::make_vec4(node.rotation.data());
  if (node.scale.size() == 3) scale = glm::make_vec3(node.scale.data());
  return matrix_from_trs(translation, rotation, scale, tally);
}

bool is_finite(const glm::dmat4& matrix) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!std::isfinite(matrix[c][r])) return false;
    }
  }
  return true;
}

glm::dmat4 matrix_from_trs(const glm::dvec3& translation, const glm::dvec4& rotation,
                           const glm::dvec3& scale, Tally& tally) {
  glm::dquat turn(rotation.w, rotation.x, rotation.y, rotation.z);
  const double length = glm::length(turn);
  if (length > 0 && std::isfinite(length)) {
    turn = turn / length;
  } else {
    tally.add("rotations without length ignored");
    turn = glm::dquat(1, 0, 0, 0);
  }
  glm::dmat4 matrix = glm::mat4_cast(turn);
  for (int c = 0; c < 3; ++c) matrix[c] *= scale[c];
  matrix[3] = glm::dvec4(translation, 1.0);
  return matrix;
}

}  // namespace mirage::gltf

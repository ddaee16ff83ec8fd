#include "server/scene/gltf/animated_object.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "protocol/base/limits.h"
#include "server/scene/gltf/accessor_reader.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/influences.h"
#include "server/scene/similarity_split.h"

namespace mirage::gltf {
namespace {

constexpr int kNone = -1;
constexpr int kProbes = 16;  // poses checked for being finite before an animation is accepted

class Builder {
 public:
  Builder(const GroupInput& input, MaterialImporter& materials, Budget& budget, Tally& tally)
      : in_(input), materials_(materials), budget_(budget), tally_(tally) {}

  Result<std::optional<AnimatedObject>> build();

 private:
  const tinygltf::Model& model() const { return in_.document.model; }
  bool find_frame();
  std::uint16_t joint_of(int node);
  std::uint16_t binding_of(int node);
  std::uint16_t fixed_joint(int node, const glm::dmat4& object_from_joint);
  Joint moving_joint(int node, std::uint16_t parent) const;
  int skin_bindings(int skin);
  Result<void> add_node(int node);
  Result<void> bind_skin(int node, int first_binding, const std::vector<VertexOrigin>& origins);
  Result<void> add_targets(int node, std::size_t first_vertex,
                           const std::vector<VertexOrigin>& origins);
  void turn_flat_faces(const tinygltf::Mesh& mesh, std::size_t first_vertex,
                       const std::vector<VertexOrigin>& origins, MorphTarget& target) const;
  void append(Mesh&& part, bool mirrored);
  bool within_limits() const;
  bool poses_are_finite() const;

  const GroupInput& in_;
  MaterialImporter& materials_;
  Budget& budget_;
  Tally& tally_;
  Similarity frame_;
  glm::dmat4 object_from_world_{1};
  AnimatedObject out_;
  Animation animation_;
  bool too_deep_ = false;                  ///< more joints than an object may have
  std::map<int, std::uint16_t> joints_;    ///< node -> joint; kNone: the world
  std::map<int, std::uint16_t> bindings_;  ///< node -> binding; for rigid parts
  std::map<int, int> skins_;               ///< skin -> its first binding
};

// The object's frame stands still: the parent of the highest moving node, or that node itself.
bool Builder::find_frame() {
  const int parent = in_.tree.parent[in_.group];
  glm::dmat4 world(1);
  if (!in_.motion.moves[in_.group]) world = in_.tree.world_from_node[in_.group];
  if (in_.motion.moves[in_.group] && parent != kNone) world = in_.tree.world_from_node[parent];
  if (!is_finite(world)) return false;
  const SplitTransform split = split_transform(world);
  if (split.residual == glm::dmat3(0)) return false;
  frame_ = split.similarity;
  const glm::dmat3 turn = glm::mat3_cast(glm::dquat(frame_.rotation)) * double{frame_.scale};
  glm::dmat4 world_from_object(turn);
  world_from_object[3] = glm::dvec4(frame_.position, 1);
  object_from_world_ = glm::inverse(world_from_object);
  return is_finite(object_from_world_);
}

std::uint16_t Builder::fixed_joint(int node, const glm::dmat4& object_from_joint) {
  Joint joint;
  joint.matrix = glm::mat4(object_from_joint);
  const auto index = static_cast<std::uint16_t>(animation_.joints.size());
  animation_.joints.push_back(joint);
  joints_[node] = index;
  return index;
}

Joint Builder::moving_joint(int node, std::uint16_t parent) const {
  const tinygltf::Node& source = model().nodes[node];
  Joint joint;
  joint.parent = parent;
  const auto clip = in_.clips.find(node);
  if (clip == in_.clips.end() || clip->second.channels.empty()) {
    Tally unused;  // flatten_nodes has reported this node already
    joint.matrix = glm::mat4(local_matrix(source, unused));
    return joint;
  }
  joint.moves = true;
  if (source.translation.size() == 3) {
    joint.translation = glm::vec3(glm::dvec3(glm::make_vec3(source.translation.data())));
  }
  if (source.scale.size() == 3) {
    joint.scale = glm::vec3(glm::dvec3(glm::make_vec3(source.scale.data())));
  }
  if (source.rotation.size() == 4) {
    const glm::dvec4 r = glm::make_vec4(source.rotation.data());
    const glm::dquat turn(r.w, r.x, r.y, r.z);
    if (glm::length(turn) > 0) joint.rotation = glm::quat(glm::normalize(turn));
  }
  return joint;
}

std::uint16_t Builder::joint_of(int node) {
  if (const auto known = joints_.find(node); known != joints_.end()) return known->second;
  // Joints are added down from the highest missing node. Still nodes hang in object space.
  std::vector<int> path;
  int at = node;
  while (at != kNone && in_.motion.moves[at] && joints_.count(at) == 0) {
    path.push_back(at);
    at = in_.tree.parent[at];
  }
  if (animation_.joints.size() + path.size() >= limits::kMaxJoints) {
    too_deep_ = true;
    return 0;
  }
  std::uint16_t parent = 0;
  if (const auto known = joints_.find(at); known != joints_.end()) {
    parent = known->second;
  } else {
    const glm::dmat4 world = at == kNone ? glm::dmat4(1) : in_.tree.world_from_node[at];
    parent = fixed_joint(at, object_from_world_ * world);
  }
  for (auto step = path.rbegin(); step != path.rend(); ++step) {
    const auto index = static_cast<std::uint16_t>(animation_.joints.size());
    animation_.joints.push_back(moving_joint(*step, parent));
    joints_[*step] = index;
    if (const auto clip = in_.clips.find(*step); clip != in_.clips.end()) {
      for (Channel channel : clip->second.channels) {
        channel.target = index;
        animation_.channels.push_back(std::move(channel));
      }
      animation_.clip_s = std::max(animation_.clip_s, clip->second.clip_s);
    }
    parent = index;
  }
  return parent;
}

std::uint16_t Builder::binding_of(int node) {
  const auto [at, is_new] =
      bindings_.try_emplace(node, static_cast<std::uint16_t>(animation_.bindings.size()));
  if (is_new) animation_.bindings.push_back({joint_of(node), glm::mat4(1)});
  return at->second;
}

/// Returns the first of the skin's bindings, one per joint in order; kNone if the skin is broken.
int Builder::skin_bindings(int index) {
  if (const auto known = skins_.find(index); known != skins_.end()) return known->second;
  const tinygltf::Skin& skin = model().skins[index];
  std::vector<float> inverse;
  if (skin.inverseBindMatrices >= 0) {
    auto values = read_floats(in_.document, skin.inverseBindMatrices, 16);
    if (!values || values->size() < skin.joints.size() * 16) return kNone;
    inverse = values.take();
  }
  if (animation_.bindings.size() + skin.joints.size() > limits::kMaxBindings) return kNone;
  const auto first = static_cast<int>(animation_.bindings.size());
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    JointBinding binding;
    binding.joint = joint_of(skin.joints[i]);
    if (!inverse.empty()) binding.joint_from_bind = glm::make_mat4(&inverse[i * 16]);
    animation_.bindings.push_back(binding);
  }
  skins_[index] = first;
  return first;
}

void Builder::append(Mesh&& part, bool mirrored) {
  const auto base = static_cast<std::uint32_t>(out_.mesh.vertices.size());
  const auto first = static_cast<std::uint32_t>(out_.mesh.indices.size());
  if (mirrored) swap_winding(part);
  for (Primitive primitive : part.primitives) {
    primitive.first_index += first;
    out_.mesh.primitives.push_back(primitive);
  }
  for (const std::uint32_t index : part.indices) out_.mesh.indices.push_back(base + index);
  out_.mesh.vertices.insert(out_.mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
}

Result<void> Builder::bind_skin(int node, int first_binding,
                                const std::vector<VertexOrigin>& origins) {
  const tinygltf::Node& source = model().nodes[node];
  const auto count = static_cast<std::uint32_t>(model().skins[source.skin].joints.size());
  const auto& primitives = model().meshes[source.mesh].primitives;
  // A vertex without weights keeps its place in the world, as at rest.
  const std::uint16_t world = binding_of(kNone);
  std::vector<std::vector<VertexBinding>> per_primitive(primitives.size());
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    auto read = read_influences(in_.document, primitives[p].attributes, count, tally_);
    if (!read) return read.error();
    per_primitive[p] = read.take();
  }
  for (const VertexOrigin& origin : origins) {
    const auto& list = per_primitive[origin.primitive];
    VertexBinding binding;
    binding.binding = glm::u16vec4(world);
    if (origin.vertex < list.size() && list[origin.vertex].weight.x > 0) {
      binding = list[origin.vertex];
      binding.binding += glm::u16vec4(static_cast<std::uint16_t>(first_binding));
    }
    animation_.vertices.push_back(binding);
  }
  return {};
}

// A face without normals in the file has its own (mesh_assemble.h), and turns with its corners: the
// target gets the change of its face vector, in units of the face vector at rest. This is exact at
// weight 1, and between for faces that fold along a line.
void Builder::turn_flat_faces(const tinygltf::Mesh& mesh, std::size_t first_vertex,
                              const std::vector<VertexOrigin>& origins, MorphTarget& target) const {
  std::vector<glm::vec3> move(origins.size(), glm::vec3(0));
  std::vector<glm::vec3> turn(origins.size(), glm::vec3(0));
  std::vector<glm::vec3> tangent(origins.size(), glm::vec3(0));
  for (std::size_t i = 0; i < target.vertex.size(); ++i) {
    move[target.vertex[i] - first_vertex] = target.position[i];
    turn[target.vertex[i] - first_vertex] = target.normal[i];
    tangent[target.vertex[i] - first_vertex] = target.tangent[i];
  }
  const std::vector<Vertex>& vertices = out_.mesh.vertices;
  const auto corner = [&](std::uint32_t vertex, float weight) {
    return glm::dvec3(vertices[vertex].position) + glm::dvec3(weight * move[vertex - first_vertex]);
  };
  const auto face = [&](const std::uint32_t* at, float weight) {
    const glm::dvec3 origin = corner(at[0], weight);
    return glm::cross(corner(at[1], weight) - origin, corner(at[2], weight) - origin);
  };
  for (const Primitive& primitive : out_.mesh.primitives) {
    const std::uint32_t* at = &out_.mesh.indices[primitive.first_index];
    if (primitive.kind != PrimitiveKind::kTriangles || at[0] < first_vertex) continue;
    const VertexOrigin& origin = origins[at[0] - first_vertex];
    if (mesh.primitives[origin.primitive].attributes.count("NORMAL") != 0) continue;
    for (const std::uint32_t* end = at + primitive.index_count; at < end; at += 3) {
      const glm::dvec3 rest = face(at, 0);
      const double side = glm::dot(rest, glm::dvec3(vertices[at[0]].normal)) < 0 ? -1 : 1;
      const double area = glm::length(rest);
      if (!(area > 0)) continue;
      for (int c = 0; c < 3; ++c) {
        turn[at[c] - first_vertex] = glm::vec3(side / area * (face(at, 1) - rest));
      }
    }
  }
  MorphTarget turned;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    constexpr glm::vec3 kStill(0);
    if (move[i] == kStill && turn[i] == kStill && tangent[i] == kStill) continue;
    turned.vertex.push_back(static_cast<std::uint32_t>(first_vertex + i));
    turned.position.push_back(move[i]);
    turned.normal.push_back(turn[i]);
    turned.tangent.push_back(tangent[i]);
  }
  target = std::move(turned);
}

Result<void> Builder::add_targets(int node, std::size_t first_vertex,
                                  const std::vector<VertexOrigin>& origins) {
  const tinygltf::Node& source = model().nodes[node];
  const tinygltf::Mesh& mesh = model().meshes[source.mesh];
  std::size_t count = 0;
  for (const auto& primitive : mesh.primitives) count = std::max(count, primitive.targets.size());
  MorphSet set;
  const std::vector<double>& rest = source.weights.empty() ? mesh.weights : source.weights;
  for (std::size_t t = 0; t < count; ++t) {
    set.rest_weights.push_back(t < rest.size() ? static_cast<float>(rest[t]) : 0.0f);
    auto target = read_target(in_.document, mesh, t, origins, first_vertex, tally_);
    if (!target) return target.error();
    turn_flat_faces(mesh, first_vertex, origins, *target);
    set.targets.push_back(target.take());
  }
  const NodeClip& clip = in_.clips.at(node);
  Channel channel = clip.weights.front();
  channel.target = static_cast<std::uint16_t>(animation_.morphs.size());
  animation_.channels.push_back(std::move(channel));
  animation_.clip_s = std::max(animation_.clip_s, clip.clip_s);
  animation_.morphs.push_back(std::move(set));
  return {};
}

Result<void> Builder::add_node(int node) {
  const tinygltf::Node& source = model().nodes[node];
  const tinygltf::Mesh& mesh = model().meshes[source.mesh];
  const auto clip = in_.clips.find(node);
  const bool morphs = clip != in_.clips.end() && !clip->second.weights.empty();
  Pose pose;
  if (!morphs) pose.weights = source.weights.empty() ? mesh.weights : source.weights;
  std::vector<VertexOrigin> origins;
  auto part = import_mesh(in_.document, source.mesh, pose, materials_, budget_, tally_, &origins);
  if (!part) return part.error();
  if (out_.name.empty()) out_.name = !mesh.name.empty() ? mesh.name : source.name;
  const std::size_t first_vertex = out_.mesh.vertices.size();
  const int skin = source.skin >= 0 ? skin_bindings(source.skin) : kNone;
  if (source.skin >= 0 && skin == kNone) tally_.add("meshes with a broken skin left unskinned");
  glm::dmat4 rest = object_from_world_ * in_.tree.world_from_node[node];
  if (skin != kNone) {
    const int joint = model().skins[source.skin].joints.front();
    const auto first = static_cast<std::size_t>(skin);
    rest = object_from_world_ * in_.tree.world_from_node[joint] *
           glm::dmat4(animation_.bindings[first].joint_from_bind);
    if (auto ok = bind_skin(node, skin, origins); !ok) return ok;
  } else {
    VertexBinding rigid;
    rigid.binding = glm::u16vec4(binding_of(node));
    animation_.vertices.insert(animation_.vertices.end(), part->vertices.size(), rigid);
  }
  append(part.take(), glm::determinant(glm::dmat3(rest)) < 0);
  return morphs ? add_targets(node, first_vertex, origins) : Result<void>{};
}

bool Builder::within_limits() const {
  std::size_t deltas = 0, widest = 0, bent = 0;
  for (const VertexBinding& vertex : animation_.vertices) bent += vertex.weight.x < 1 ? 1 : 0;
  for (const MorphSet& set : animation_.morphs) {
    widest = std::max(widest, set.targets.size());
    std::size_t moved = 0;
    for (const MorphTarget& target : set.targets) {
      deltas += target.vertex.size();
      moved = std::max(moved, target.vertex.size());
    }
    bent += moved;
  }
  return !too_deep_ && animation_.clip_s > 0 && animation_.joints.size() <= limits::kMaxJoints &&
         animation_.bindings.size() <= limits::kMaxBindings &&
         animation_.channels.size() <= limits::kMaxChannels &&
         animation_.morphs.size() <= limits::kMaxMorphSets && widest <= limits::kMaxMorphTargets &&
         deltas <= limits::kMaxMorphDeltas && bent <= limits::kMaxBentVertices &&
         out_.mesh.vertices.size() <= limits::kMaxMeshVertices;
}

bool Builder::poses_are_finite() const {
  std::vector<glm::vec3> points;
  for (int i = 0; i < kProbes; ++i) {
    pose_positions(out_.mesh.vertices, animation_,
                   animation_.clip_s * static_cast<double>(i) / kProbes, points);
    for (const glm::vec3& p : points) {
      const float most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      if (!(most <= kMaxCoordinate)) return false;
      if (!std::isfinite(p.x + p.y + p.z)) return false;
    }
  }
  return true;
}

Result<std::optional<AnimatedObject>> Builder::build() {
  const auto at_rest = [&](const char* why) -> std::optional<AnimatedObject> {
    tally_.add(why);
    return std::nullopt;
  };
  if (!find_frame()) return at_rest("animations below a transform without size left at rest");
  for (const int node : in_.nodes) {
    if (auto ok = add_node(node); !ok) return ok.error();
  }
  if (!within_limits()) return at_rest("animations beyond the limits left at rest");
  if (!poses_are_finite()) return at_rest("animations with poses that are not finite left at rest");
  out_.animation = std::make_shared<const Animation>(std::move(animation_));
  out_.world_from_object = frame_;
  return std::optional<AnimatedObject>(std::move(out_));
}

}  // namespace

Result<std::optional<AnimatedObject>> build_animated(const GroupInput& input,
                                                     MaterialImporter& materials, Budget& budget,
                                                     Tally& tally) {
  return Builder(input, materials, budget, tally).build();
}

}  // namespace mirage::gltf

#include "server/scene/gltf/scene_assembler.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "protocol/codec/animation_codec.h"
#include "protocol/impostor/motion.h"
#include "server/scene/gltf/accessor_reader.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/mesh_assemble.h"
#include "server/scene/similarity_split.h"

namespace mirage::gltf {
namespace {

constexpr double kResidualGrid = 1e-5;  // residuals that agree this closely share one baked mesh
constexpr char kInstancing[] = "EXT_mesh_gpu_instancing";

std::array<std::int64_t, 9> grid_key(const glm::dmat3& residual) {
  std::array<std::int64_t, 9> key{};
  for (int i = 0; i < 9; ++i) {
    key[static_cast<std::size_t>(i)] = std::llround(residual[i / 3][i % 3] / kResidualGrid);
  }
  return key;
}

/// Returns the accessor of an optional attribute of EXT_mesh_gpu_instancing, -1 if absent.
int attribute(const tinygltf::Value& attributes, const char* semantic) {
  return attributes.Has(semantic) ? attributes.Get(semantic).GetNumberAsInt() : -1;
}

std::vector<Importance> importance_of_nodes(const Document& document, const NodeTree& tree) {
  const ImportanceMarks& marks = document.importance;
  std::vector<Importance> out(document.model.nodes.size(), Importance::kNormal);
  for (const int node : tree.order) {
    const auto own = marks.of_node.find(node);
    const auto mesh = marks.of_mesh.find(document.model.nodes[node].mesh);
    if (own != marks.of_node.end()) {
      out[node] = own->second;
    } else if (mesh != marks.of_mesh.end()) {
      out[node] = mesh->second;
    } else if (tree.parent[node] >= 0) {
      out[node] = out[tree.parent[node]];
    }
  }
  return out;
}

}  // namespace

SceneAssembler::SceneAssembler(const Document& document, const NodeTree& tree,
                               const std::map<int, NodeClip>& clips, Tally& tally)
    : document_(document),
      tree_(tree),
      clips_(clips),
      motion_(find_motion(document, tree, clips)),
      importance_(importance_of_nodes(document, tree)),
      tally_(tally),
      materials_(document, tally),
      budget_(document.limits) {}

Result<void> SceneAssembler::add_node(int node) {
  const tinygltf::Node& source = document_.model.nodes[node];
  if (source.mesh < 0) return {};
  const int group = motion_.group[node];
  if (group < 0) return add_at_rest(node);
  // Copies can share the object only if nothing but its shape moves; then each copy has just its
  // own pose.
  if (source.extensions.count(kInstancing) != 0 &&
      (group != node || motion_.moves[node] || source.skin >= 0)) {
    tally_.add("instanced copies of a moving mesh left at rest");
    return add_at_rest(node);
  }
  groups_[group].push_back(node);
  return {};
}

Result<void> SceneAssembler::finish() {
  for (const auto& [group, nodes] : groups_) {
    if (auto ok = add_group(group, nodes); !ok) return ok;
  }
  return {};
}

Result<void> SceneAssembler::add_group(int group, const std::vector<int>& nodes) {
  const GroupInput input{document_, tree_, motion_, clips_, group, nodes};
  auto object = build_animated(input, materials_, budget_, tally_);
  if (!object) return object.error();
  if (object->has_value()) {
    if ((*object)->mesh.primitives.empty()) return {};
    const Similarity world_from_object = (*object)->world_from_object;
    const auto offset = document_.animations.clip_offset_s.find(group);
    const bool given = offset != document_.animations.clip_offset_s.end();
    const auto instancing = document_.model.nodes[group].extensions.find(kInstancing);
    const std::uint32_t index = add_animated(std::move(**object));
    const float clip_offset_s = given ? static_cast<float>(offset->second) : 0.0f;
    if (document_.model.nodes[group].mesh >= 0 &&
        instancing != document_.model.nodes[group].extensions.end()) {
      return place_copies(group, index, instancing->second, clip_offset_s);
    }
    Importance importance = Importance::kScenery;
    for (const int node : nodes) importance = std::max(importance, importance_[node]);
    scene_.instances.push_back({index, world_from_object, clip_offset_s, importance});
    return {};
  }
  for (const int node : nodes) {
    if (auto ok = add_at_rest(node); !ok) return ok;
  }
  return {};
}

// Equal parts (the wheels of a truck) become one object, so they share their tiles.
std::uint32_t SceneAssembler::add_animated(AnimatedObject&& object) {
  const Bytes bytes = encode_animation(object.animation.get());
  const std::uint64_t hash = XXH3_64bits(bytes.data(), bytes.size());
  const auto same = [&](std::uint32_t index) {
    const SceneObject& other = scene_.objects[index];
    const Mesh &a = other.mesh, &b = object.mesh;
    const auto equal = [](const auto& x, const auto& y) {
      return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
    };
    return equal(a.vertices, b.vertices) && equal(a.indices, b.indices) &&
           a.primitives.size() == b.primitives.size() &&
           std::equal(a.primitives.begin(), a.primitives.end(), b.primitives.begin(),
                      [](const Primitive& p, const Primitive& q) {
                        return p.kind == q.kind && p.first_index == q.first_index &&
                               p.index_count == q.index_count && p.material == q.material;
                      }) &&
           encode_animation(other.animation.get()) == bytes;
  };
  std::vector<std::uint32_t>& candidates = animated_[hash];
  const auto found = std::find_if(candidates.begin(), candidates.end(), same);
  if (found != candidates.end()) return *found;
  const auto index = static_cast<std::uint32_t>(scene_.objects.size());
  candidates.push_back(index);
  scene_.objects.push_back({object.name, std::move(object.mesh), std::move(object.animation)});
  return index;
}

// Each copy starts elsewhere in the clip; a crowd in step would look unnatural.
Result<void> SceneAssembler::place_copies(int node, std::uint32_t object,
                                          const tinygltf::Value& extension, float clip_offset_s) {
  auto copies = instance_matrices(extension);
  if (!copies) return copies.error();
  const bool uneven = split_transform(tree_.world_from_node[node]).has_residual;
  const double clip_s = scene_.objects[object].animation->clip_s;
  for (std::size_t i = 0; i < copies->size(); ++i) {
    const glm::dmat4 world = tree_.world_from_node[node] * (*copies)[i];
    if (!is_finite(world)) {
      tally_.add("instances with a transform that is not finite left out");
      continue;
    }
    const SplitTransform split = split_transform(world);
    if (uneven || split.has_residual) {
      tally_.add("moving copies that are sheared, mirrored or scaled unevenly left out");
      continue;
    }
    if (scene_.instances.size() >= kMaxInstances) {
      return make_error(ErrorId::kSceneLimit, "the scene needs more than " +
                                                  std::to_string(kMaxInstances) + " instances");
    }
    const float own = copy_offset(static_cast<std::uint32_t>(i), clip_s);
    scene_.instances.push_back({object, split.similarity, clip_offset_s + own, importance_[node]});
  }
  return {};
}

Result<void> SceneAssembler::add_at_rest(int node) {
  const tinygltf::Node& source = document_.model.nodes[node];
  Pose pose;
  int skin = source.skin;
  if (skin >= 0) pose.joint_matrices = skin_matrices(skin);
  if (pose.joint_matrices.empty()) skin = -1;
  auto base = base_of(node, std::move(pose), skin);
  if (!base) return base.error();
  if (bases_[*base].empty) return {};
  // glTF §3.7.3.3: joints alone place a skinned mesh.
  const glm::dmat4 world = skin >= 0 ? glm::dmat4(1) : tree_.world_from_node[node];
  const auto instancing = source.extensions.find(kInstancing);
  if (instancing == source.extensions.end() || skin >= 0)
    return place(*base, world, importance_[node]);

  auto copies = instance_matrices(instancing->second);
  if (!copies) {
    return make_error(copies.error().id,
                      "nodes[" + std::to_string(node) + "]: " + copies.error().text);
  }
  for (const glm::dmat4& copy : *copies) {
    if (auto ok = place(*base, world * copy, importance_[node]); !ok) return ok;
  }
  return {};
}

Result<std::size_t> SceneAssembler::base_of(int node, Pose pose, int skin) {
  const tinygltf::Node& source = document_.model.nodes[node];
  const tinygltf::Mesh& mesh = document_.model.meshes[source.mesh];
  pose.weights = source.weights.empty() ? mesh.weights : source.weights;
  const auto [entry, is_new] =
      base_index_.try_emplace(BaseKey{source.mesh, skin, pose.weights}, bases_.size());
  if (!is_new) return entry->second;
  auto imported = import_mesh(document_, source.mesh, pose, materials_, budget_, tally_);
  if (!imported) return imported.error();
  Base base;
  base.mesh = imported.take();
  base.unit = normalise_extent(base.mesh);
  base.name = !mesh.name.empty() ? mesh.name : source.name;
  base.empty = base.mesh.primitives.empty();
  if (base.empty) tally_.add("meshes with nothing to draw");
  bases_.push_back(std::move(base));
  return bases_.size() - 1;
}

Result<void> SceneAssembler::place(std::size_t base, const glm::dmat4& world,
                                   Importance importance) {
  if (!is_finite(world)) {
    tally_.add("instances with a transform that is not finite left out");
    return {};
  }
  const glm::dmat4 unit = glm::scale(glm::dmat4(1), glm::dvec3(bases_[base].unit));
  const SplitTransform split = split_transform(world * unit);
  if (split.residual == glm::dmat3(0)) {
    tally_.add("instances without size left out");
    return {};
  }
  if (scene_.instances.size() >= kMaxInstances) {
    return make_error(ErrorId::kSceneLimit,
                      "the scene needs more than " + std::to_string(kMaxInstances) + " instances");
  }
  auto object = object_of(base, split.residual, split.has_residual);
  if (!object) return object.error();
  scene_.instances.push_back({*object, split.similarity, 0, importance});
  return {};
}

Result<std::uint32_t> SceneAssembler::object_of(std::size_t index, const glm::dmat3& residual,
                                                bool baked) {
  Base& base = bases_[index];
  const auto next = static_cast<std::uint32_t>(scene_.objects.size());
  if (!baked) {
    if (base.object < 0) {
      base.object = static_cast<int>(next);
      scene_.objects.push_back({base.name, std::move(base.mesh)});
    }
    return static_cast<std::uint32_t>(base.object);
  }
  const auto [entry, is_new] = baked_index_.try_emplace(BakedKey{index, grid_key(residual)}, next);
  if (!is_new) return entry->second;
  const Mesh& mesh = base.object < 0 ? base.mesh : scene_.objects[base.object].mesh;
  if (auto ok = budget_.take(mesh.vertices.size(), mesh.indices.size()); !ok) return ok.error();
  if (auto ok = budget_.take_primitives(mesh.primitives.size()); !ok) return ok.error();
  Mesh copy = bake(mesh, residual);
  scene_.objects.push_back({base.name, std::move(copy), nullptr,
                            BakedShape{static_cast<std::uint32_t>(index), residual}});
  return next;
}

std::vector<glm::dmat4> SceneAssembler::skin_matrices(int index) {
  const tinygltf::Skin& skin = document_.model.skins[index];
  std::vector<glm::dmat4> matrices;
  std::vector<float> inverse;
  if (skin.inverseBindMatrices >= 0) {
    auto values = read_floats(document_, skin.inverseBindMatrices, 16);
    if (values && values->size() >= skin.joints.size() * 16) inverse = values.take();
    if (inverse.empty()) {
      tally_.add("meshes with a broken skin left unskinned");
      return matrices;
    }
  }
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    glm::dmat4 matrix = tree_.world_from_node[skin.joints[i]];
    if (!inverse.empty()) matrix = matrix * glm::dmat4(glm::make_mat4(&inverse[i * 16]));
    if (!is_finite(matrix)) {
      tally_.add("meshes with a broken skin left unskinned");
      return {};
    }
    matrices.push_back(matrix);
  }
  return matrices;
}

Result<std::vector<glm::dmat4>> SceneAssembler::instance_matrices(
    const tinygltf::Value& extension) {
  struct Column {
    const char* semantic;
    std::size_t components;
    std::vector<float> values;
  };
  Column columns[] = {{"TRANSLATION", 3, {}}, {"ROTATION", 4, {}}, {"SCALE", 3, {}}};
  std::size_t count = 0;
  for (Column& column : columns) {
    const int accessor = attribute(extension.Get("attributes"), column.semantic);
    if (accessor < 0) continue;
    if (document_.model.accessors[accessor].count > kMaxInstances) {
      return make_error(ErrorId::kSceneLimit,
                        "more than " + std::to_string(kMaxInstances) + " instances");
    }
    auto values = read_floats(document_, accessor, column.components);
    if (values && count != 0 && values->size() / column.components != count) {
      values = make_error(ErrorId::kSceneRange,
                          std::string(kInstancing) + " has " + column.semantic + " of " +
                              std::to_string(values->size() / column.components) +
                              " elements beside " + std::to_string(count));
    }
    if (!values) {
      auto ok = tally_.forgive("attributes of instanced copies that cannot be used left out",
                               values.error());
      if (!ok) return ok.error();
      continue;
    }
    count = values->size() / column.components;
    column.values = values.take();
  }
  if (count == 0) return std::vector<glm::dmat4>{glm::dmat4(1)};  // the mesh alone
  std::vector<glm::dmat4> matrices(count);
  for (std::size_t i = 0; i < count; ++i) {
    auto vector = [i](const Column& column, int c, double fallback) {
      return column.values.empty()
                 ? fallback
                 : static_cast<double>(
                       column.values[i * column.components + static_cast<std::size_t>(c)]);
    };
    glm::dvec3 translation;
    glm::dvec4 rotation;
    glm::dvec3 scale;
    for (int c = 0; c < 3; ++c) translation[c] = vector(columns[0], c, 0);
    for (int c = 0; c < 4; ++c) rotation[c] = vector(columns[1], c, c == 3 ? 1 : 0);
    for (int c = 0; c < 3; ++c) scale[c] = vector(columns[2], c, 1);
    matrices[i] = matrix_from_trs(translation, rotation, scale, tally_);
  }
  return matrices;
}

Result<Scene> SceneAssembler::take(const Workers& workers) {
  Result<std::vector<Image>> images = materials_.take_images(workers);
  if (!images) return images.error();
  scene_.materials = materials_.take_materials();
  scene_.images = images.take();
  if (scene_.objects.empty()) {
    // Materials and images of meshes that are empty are not needed either.
    scene_.materials.clear();
    scene_.images.clear();
  }
  return std::move(scene_);
}

}  // namespace mirage::gltf

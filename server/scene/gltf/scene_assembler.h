#pragma once
// Turns nodes with meshes into objects and instances of a Scene. Instances whose transforms are
// similarities share a mesh. Other transforms get baked copies, shared if equal.

#include <array>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "server/scene/gltf/animated_object.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/material_import.h"
#include "server/scene/gltf/mesh_import.h"
#include "server/scene/gltf/node_import.h"
#include "server/scene/gltf/tally.h"
#include "server/scene/scene.h"

namespace mirage::gltf {

class SceneAssembler {
 public:
  SceneAssembler(const Document& document, const NodeTree& tree,
                 const std::map<int, NodeClip>& clips, Tally& tally);

  /// Adds the content of a node; moving content waits for finish(). Errors: those of import_mesh,
  /// kSceneLimit.
  Result<void> add_node(int node);
  /// Adds the moving content, one object per group. Errors: as add_node.
  Result<void> finish();

  /// Returns objects, instances, materials and images; the assembler is then empty. Error
  /// kSceneLimit: an image beyond the limits.
  Result<Scene> take(const Workers& workers);

 private:
  /// A mesh in one pose. Its vertices move into the object that first shows it unbaked.
  struct Base {
    Mesh mesh;
    double unit = 1;  ///< file units per unit of the mesh (normalise_extent)
    std::string name;
    int object = -1;
    bool empty = false;
  };
  using BaseKey = std::tuple<int, int, std::vector<double>>;  // mesh, skin, morph weights
  using BakedKey = std::pair<std::size_t, std::array<std::int64_t, 9>>;

  Result<void> add_at_rest(int node);
  Result<void> add_group(int group, const std::vector<int>& nodes);
  /// Returns the index of the object, or of an equal one.
  std::uint32_t add_animated(AnimatedObject&& object);
  /// EXT_mesh_gpu_instancing for a mesh whose shape moves. Errors: as instance_matrices, and
  /// kSceneLimit.
  Result<void> place_copies(int node, std::uint32_t object, const tinygltf::Value& extension,
                            float clip_offset_s);
  Result<std::size_t> base_of(int node, Pose pose, int skin);
  Result<void> place(std::size_t base, const glm::dmat4& world, Importance importance);
  Result<std::uint32_t> object_of(std::size_t base, const glm::dmat3& residual, bool baked);
  /// Returns the joint matrices of a node's skin; empty, with a warning, if the skin is broken.
  std::vector<glm::dmat4> skin_matrices(int skin);
  /// Returns node_from_instance of each copy of EXT_mesh_gpu_instancing. Errors: kSceneRange,
  /// kSceneFormat.
  Result<std::vector<glm::dmat4>> instance_matrices(const tinygltf::Value& extension);

  const Document& document_;
  const NodeTree& tree_;
  const std::map<int, NodeClip>& clips_;
  const MotionGroups motion_;
  const std::vector<Importance> importance_;  ///< by node: its own, its mesh's or its parent's
  std::map<int, std::vector<int>> groups_;    ///< group -> its mesh nodes
  std::map<std::uint64_t, std::vector<std::uint32_t>> animated_;  ///< content hash -> objects
  Tally& tally_;
  MaterialImporter materials_;
  Budget budget_;
  Scene scene_;
  std::vector<Base> bases_;
  std::map<BaseKey, std::size_t> base_index_;
  std::map<BakedKey, std::uint32_t> baked_index_;
};

}  // namespace mirage::gltf

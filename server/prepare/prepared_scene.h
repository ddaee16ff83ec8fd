#pragma once
// A scene ready to serve: content hash, what clients are told of each object, geometry on request.

#include <memory>

#include "protocol/base/result.h"
#include "server/base/stage_progress.h"
#include "server/base/stage_times.h"
#include "server/prepare/grouping.h"
#include "server/prepare/leave_out.h"
#include "server/prepare/object_description.h"
#include "server/prepare/object_geometry.h"

namespace mirage {

class CacheDirectory;

struct PreparedScene {
  Scene scene;
  LeftOutOfScene left_out;
  /// What the scene came with, for proofs; nullptr unless it was asked to be kept.
  struct Imported {
    std::vector<Material> materials;
    std::vector<Image> images;
  };
  std::shared_ptr<const Imported> imported;
  std::uint64_t revision = 0;              ///< hash of all content that pixels depend on
  std::vector<ObjectDescription> objects;  ///< by object of the scene
  std::vector<ObjectGeometry> geometry;    ///< the same
  std::vector<ImageDescription> images;
  /// By image (make_mips).
  std::vector<std::vector<Image>> mips;
  Grouping grouping;
  std::vector<Mesh> parts;      ///< InstanceGroup::part, in their object's space
  glm::dvec3 bounds_center{0};  ///< sphere around all instances, world
  double bounds_radius = 1;
  StageTimes load_times;

  /// Anything of the scene throws a shadow (numerics.md section 5, rule 18).
  bool has_casters() const;
  /// Some object has blended surfaces: what is laid over each other wants more than 8 bits.
  bool blends() const;
  /// Some object moves by itself.
  bool animated() const;
  /// Instances as clients number them: the scene's, then one for each group.
  std::size_t instance_count() const { return scene.instances.size() + grouping.groups.size(); }
  Instance instance(std::size_t index) const;
  /// The group an instance stands for; nullptr when it is none.
  const InstanceGroup* group_of_instance(std::size_t index) const {
    const std::size_t own = scene.instances.size();
    return index < own ? nullptr : &grouping.groups[index - own];
  }
  /// Index of the instance whose group `index` belongs to, or of which it is a part; kNoGroup:
  /// none.
  std::uint32_t parent(std::size_t index) const;
  /// How the instance is cut; nullptr when it is not.
  const Cut* cut(std::size_t index) const;
  /// Indices of what a group consists of, or of an instance's parts.
  std::vector<std::uint32_t> members(std::size_t index) const;
  /// Objects as clients number them: the scene's, then one for each group.
  std::size_t object_count() const { return scene.objects.size() + grouping.groups.size(); }
  /// Of a group it is made anew; of any other the scene has it.
  std::shared_ptr<const ObjectDescription> description(std::size_t object) const;
  /// The group an object stands for; nullptr when it is none.
  const InstanceGroup* group(std::size_t object) const {
    const std::size_t own = scene.objects.size();
    return object < own ? nullptr : &grouping.groups[object - own];
  }
};

struct SceneLoadOptions {
  bool keep_imported = false;         ///< PreparedScene::imported
  std::size_t threads = 0;            ///< that work at it; 0: as many as there are cores
  bool strict = false;                ///< files: refuse what viewers forgive (ImportOptions)
  std::string environment = "none";   ///< `--environment`; empty: what suits the scene
  CacheDirectory* cache = nullptr;    ///< of levels of detail and mips; nullptr: all is made
  StageProgress::Tell progress = {};  ///< told how far a long stage is
};

/// Loads `spec` (a path or `builtin:NAME?…`) and prepares it: the same however many threads work,
/// and whether from the cache or not.
/// Errors: those of the importers, kSceneLimit when it exceeds limits.h.
Result<std::shared_ptr<const PreparedScene>> load_scene(const std::string& spec,
                                                        const SceneLoadOptions& options = {});
/// The same of a scene that is there.
Result<std::shared_ptr<const PreparedScene>> prepare_scene(Scene scene,
                                                           const SceneLoadOptions& options = {});

}  // namespace mirage

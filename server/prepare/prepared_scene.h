#pragma once
// A scene ready to serve: content hash, the descriptions of its objects, geometry on request.

#include <atomic>
#include <memory>

#include "protocol/base/result.h"
#include "protocol/model/view_place.h"
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
  /// The scene's content as imported, for proofs; nullptr unless it was to be kept.
  struct Imported {
    std::vector<Material> materials;
    std::vector<Image> images;
  };
  std::shared_ptr<const Imported> imported;
  std::uint64_t revision = 0;              ///< hash of all content that pixels depend on
  std::vector<ObjectDescription> objects;  ///< by object of the scene
  /// Levels by object of the scene. Like ObjectDescription::lods, empty until make_levels() ends.
  std::vector<ObjectGeometry> geometry;
  std::vector<ImageDescription> images;
  /// Mip levels by image (make_mips).
  std::vector<std::vector<Image>> mips;
  Grouping grouping;
  std::vector<Touching> touching;  ///< by object of the scene
  std::vector<Mesh> parts;         ///< of InstanceGroup::part, in their object's space
  glm::dvec3 bounds_center{0};     ///< sphere around all instances, world
  double bounds_radius = 1;
  StageTimes load_times;

  /// True if something in the scene casts a shadow (numerics.md section 5, rule 18).
  bool has_casters() const;
  /// True if an object has blended surfaces. Their layers need targets with more than 8 bits.
  bool blends() const;
  /// True if an object is animated.
  bool animated() const;
  /// Number of instances in the clients' numbering: the scene's, then one for each group.
  std::size_t instance_count() const { return scene.instances.size() + grouping.groups.size(); }
  Instance instance(std::size_t index) const;
  /// Returns the group that an instance represents; nullptr: none.
  const InstanceGroup* group_of_instance(std::size_t index) const {
    const std::size_t own = scene.instances.size();
    return index < own ? nullptr : &grouping.groups[index - own];
  }
  /// Returns the index of the instance whose group `index` belongs to, or whose part it is;
  /// kNoGroup: none.
  std::uint32_t parent(std::size_t index) const;
  /// Returns the cut of an instance; nullptr: it is not cut.
  const Cut* cut(std::size_t index) const;
  /// Returns the indices of a group's members, or of an instance's parts.
  std::vector<std::uint32_t> members(std::size_t index) const;
  /// Number of objects in the clients' numbering: the scene's, then one for each group.
  std::size_t object_count() const { return scene.objects.size() + grouping.groups.size(); }
  /// Returns an object's description. That of a group is made on each call, the others belong to
  /// the scene.
  std::shared_ptr<const ObjectDescription> description(std::size_t object) const;
  /// Returns the group that an object represents; nullptr: none.
  const InstanceGroup* group(std::size_t object) const {
    const std::size_t own = scene.objects.size();
    return object < own ? nullptr : &grouping.groups[object - own];
  }
};

struct SceneLoadOptions {
  bool keep_imported = false;  ///< keeps PreparedScene::imported
  std::size_t threads = 0;     ///< threads that work at it; 0: as many as there are cores
  /// refuses files with defects that viewers forgive (ImportOptions)
  bool strict = false;
  SceneChoice choice = {};             ///< of clip and variant (ImportOptions)
  std::uint64_t megabytes = 3072;      ///< memory that the scene may take (ImportOptions)
  std::string environment = "none";    ///< `--environment`; empty: chosen by the scene
  bool studio = true;                  ///< `--look studio` (set_look)
  std::optional<ViewPlace> home = {};  ///< in place of the scene's own home view
  CacheDirectory* cache = nullptr;     ///< for levels of detail and mips; nullptr: all are made
  StageProgress::Tell progress = {};   ///< receives the progress of long stages
};

/// Imports `spec` as load_scene() does, with its light, and prepares nothing. Errors: those of the
/// importers and of set_environment().
Result<Scene> import_scene(const std::string& spec, const SceneLoadOptions& options);

/// Loads `spec` (a path or `builtin:NAME?…`) and prepares it. The number of threads and the cache
/// change nothing. Errors: those of the importers; kSceneLimit if it exceeds limits.h.
Result<std::shared_ptr<const PreparedScene>> load_scene(const std::string& spec,
                                                        const SceneLoadOptions& options = {});
/// Prepares a scene that is loaded already.
Result<std::shared_ptr<const PreparedScene>> prepare_scene(Scene scene,
                                                           const SceneLoadOptions& options = {});

/// Loads as load_scene() does, without levels of detail: make_levels() makes them.
Result<std::shared_ptr<PreparedScene>> load_without_levels(const std::string& spec,
                                                           const SceneLoadOptions& options);
/// Makes the levels of detail of all objects. Meanwhile, other threads may read all of the scene
/// but the levels. Once `stopped` is true (nullptr: never), it ends early: some levels are then
/// missing.
void make_levels(PreparedScene& prepared, const SceneLoadOptions& options,
                 const std::atomic<bool>* stopped = nullptr);

}  // namespace mirage

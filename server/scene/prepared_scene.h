#pragma once
// A scene ready to serve: content hash, what clients are told of each object, geometry on request.

#include <memory>

#include "protocol/model_codec.h"
#include "protocol/object_proxy.h"
#include "server/scene/grouping.h"
#include "server/scene/scene.h"

namespace mirage {

struct PreparedScene {
  Scene scene;
  std::uint64_t revision = 0;  ///< hash of all content that pixels depend on
  /// The scene's objects, then its groups as objects of their own.
  std::vector<ObjectDescription> objects;
  Grouping grouping;
  glm::dvec3 bounds_center{0};  ///< sphere around all instances, world
  double bounds_radius = 1;

  /// Instances as clients number them: the scene's, then one for each group.
  std::size_t instance_count() const { return scene.instances.size() + grouping.groups.size(); }
  Instance instance(std::size_t index) const;
  /// Index of the instance whose group `index` belongs to; kNoGroup: none.
  std::uint32_t parent(std::size_t index) const;
  /// The group an object stands for; nullptr when it is none.
  const InstanceGroup* group(std::size_t object) const {
    const std::size_t own = scene.objects.size();
    return object < own ? nullptr : &grouping.groups[object - own];
  }
};

/// Loads `spec` (a path or `builtin:NAME?…`) and prepares it. Errors: those of the importers,
/// kSceneLimit when it exceeds limits.h.
Result<std::shared_ptr<const PreparedScene>> load_scene(const std::string& spec);

/// Bounds, hull, mean colour and needs of one object.
ObjectDescription describe_object(const SceneObject& object, const Scene& scene);

/// The object with only the materials and images it uses.
ObjectModel object_model(const Scene& scene, std::size_t object);

}  // namespace mirage

#pragma once
// A loaded scene: immutable after loading, shared by all server stages.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/light_probe.h"
#include "protocol/model/animation.h"
#include "protocol/model/model.h"
#include "protocol/model/scene_types.h"

namespace mirage {

/// What an object's mesh was made of: objects of the same base differ by their shapes alone.
struct BakedShape {
  std::uint32_t base = 0;
  glm::dmat3 shape{1};  ///< that the base's vertices were multiplied by
};

/// An impostor object: one mesh with its materials, in its own space.
struct SceneObject {
  std::string name;
  Mesh mesh;
  /// Set: the mesh is in bind space, and pose_vertices() takes it to object space.
  std::shared_ptr<const Animation> animation = nullptr;
  std::optional<BakedShape> baked = std::nullopt;
};

struct Scene {
  std::string name;
  std::vector<SceneObject> objects;
  std::vector<Material> materials;  ///< at least one when any object exists
  std::vector<Image> images;
  std::vector<Instance> instances;
  Lighting lighting;
  bool own_lights = true;  ///< false: `lighting` is what is taken where a file says nothing
  std::shared_ptr<const LightProbe> probe;  ///< that lighting.probe names; nullptr: none
  Environment environment;
  HomeView home;
  /// One line per kind of recoverable defect, with its count ("3 triangles with NaN dropped").
  std::vector<std::string> warnings;

  std::uint64_t triangles() const;  ///< over all instances
};

}  // namespace mirage

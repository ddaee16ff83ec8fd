#pragma once
// A loaded scene: immutable after loading, shared by all server stages.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/animation.h"
#include "protocol/light_probe.h"
#include "protocol/model.h"
#include "protocol/result.h"
#include "protocol/scene_types.h"

namespace mirage {

/// An impostor object: one mesh with its materials, in its own space.
struct SceneObject {
  std::string name;
  Mesh mesh;
  /// Set: the mesh is in bind space, and pose_vertices() takes it to object space.
  std::shared_ptr<const Animation> animation = nullptr;
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

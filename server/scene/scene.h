#pragma once
// A loaded scene: immutable after loading, shared by all stages of the server.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/light_probe.h"
#include "protocol/impostor/motion.h"
#include "protocol/model/animation.h"
#include "protocol/model/model.h"
#include "protocol/model/scene_types.h"

namespace mirage {

/// Origin of an object's mesh. Objects with the same base differ only by their shapes.
struct BakedShape {
  std::uint32_t base = 0;
  glm::dmat3 shape{1};  ///< multiplies the base's vertices
};

/// An impostor object: one mesh with its materials, in its own space.
struct SceneObject {
  std::string name;
  Mesh mesh;
  /// If set, the mesh is in bind space, and pose_vertices() takes it to object space.
  std::shared_ptr<const Animation> animation = nullptr;
  std::optional<BakedShape> baked = std::nullopt;
  Track track = {};  ///< what the poses are relative to
};

struct Scene {
  std::string name;
  std::vector<SceneObject> objects;
  std::vector<Material> materials;  ///< at least one if any object exists
  std::vector<Image> images;
  std::vector<Instance> instances;
  Lighting lighting;
  bool own_lights = true;  ///< false: the file has no lights, and `lighting` is the default
  std::shared_ptr<const LightProbe> probe;  ///< the probe of lighting.probe; nullptr: none
  Environment environment;
  HomeView home;
  SceneChoices choices;
  /// One line per kind of recoverable defect, with its count ("3 triangles with NaN dropped").
  std::vector<std::string> warnings;

  std::uint64_t triangles() const;      ///< over all instances
  std::uint64_t own_triangles() const;  ///< over all objects, each once
};

}  // namespace mirage

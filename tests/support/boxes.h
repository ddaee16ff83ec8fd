#pragma once
// Boxes: scenes of boxes, without a file.

#include <utility>
#include <vector>

#include "server/scene/scene.h"

namespace mirage::test {

/// Returns a box around its origin.
inline SceneObject box(const glm::vec3& half) {
  SceneObject out;
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) {
      for (const float z : {-1.0f, 1.0f}) {
        Vertex v;
        v.position = half * glm::vec3(x, y, z);
        out.mesh.vertices.push_back(v);
      }
    }
  }
  Primitive faces;
  out.mesh.indices = {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                      2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};
  faces.index_count = static_cast<std::uint32_t>(out.mesh.indices.size());
  out.mesh.primitives = {faces};
  return out;
}

/// An object's index, and where it stands.
using PlacedObjects = std::vector<std::pair<std::uint32_t, glm::dvec3>>;

/// Returns a scene of these objects, in one material.
inline Scene placed_scene(std::vector<SceneObject> objects, const PlacedObjects& placed) {
  Scene scene;
  scene.materials.resize(1);
  scene.objects = std::move(objects);
  for (const auto& [object, position] : placed) {
    Instance one;
    one.object = object;
    one.world_from_object.position = position;
    scene.instances.push_back(one);
  }
  return scene;
}

}  // namespace mirage::test

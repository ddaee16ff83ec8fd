#pragma once
// The box around a scene, from the boxes of its objects.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "server/scene/scene.h"

namespace mirage::gltf {

struct Bounds {
  glm::dvec3 low{0};
  glm::dvec3 high{0};
  bool empty = true;

  void add(const glm::dvec3& point);
  glm::dvec3 center() const { return 0.5 * (low + high); }
  double radius() const { return 0.5 * glm::length(high - low); }
};

/// Returns the positions of an object as it is first seen: at rest, at the start of its clip, or at
/// the first of 16 poses that has an extent. Space of the object.
std::vector<glm::vec3> shown_positions(const SceneObject& object);

/// The positions of all objects as they are first seen. Those of still objects are not copied.
class ShownPositions {
 public:
  /// The scene must outlive this object.
  explicit ShownPositions(const Scene& scene) : scene_(scene), posed_(scene.objects.size()) {}
  /// Returns the position of a vertex, in the object's space.
  glm::vec3 at(std::uint32_t object, std::uint32_t vertex) {
    const SceneObject& of = scene_.objects[object];
    if (!of.animation) return of.mesh.vertices[vertex].position;
    if (posed_[object].empty()) posed_[object] = shown_positions(of);
    return posed_[object][vertex];
  }

 private:
  const Scene& scene_;
  std::vector<std::vector<glm::vec3>> posed_;
};

/// Returns the world box of all instances; it is larger than necessary for rotated objects.
Bounds scene_bounds(const Scene& scene);

}  // namespace mirage::gltf

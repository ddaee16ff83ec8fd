#pragma once
// The box around a scene, from the boxes of its objects.

#include <glm/glm.hpp>

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

/// Returns the world box of all instances; it is larger than necessary for rotated objects.
Bounds scene_bounds(const Scene& scene);

}  // namespace mirage::gltf

#pragma once
// Proxy triangles: the triangles of the proxies that impostors are drawn on.

#include <glm/glm.hpp>
#include <vector>

#include "protocol/impostor/object_proxy.h"

namespace mirage {

struct ProxyVertex {
  glm::vec3 position, normal;
  float parallax;  ///< object units, see ConvexHull
};

/// Returns the unit cube from (0, 0, 0) to (1, 1, 1).
std::vector<ProxyVertex> cube_triangles(float parallax);
/// Returns the hull in object space, without triangles that have no area.
std::vector<ProxyVertex> hull_triangles(const ConvexHull& hull);
/// Returns the proxy for drawing with parallax, object space: the hull, or without one the bounding
/// box.
std::vector<ProxyVertex> warp_triangles(const ObjectDescription& object);

}  // namespace mirage

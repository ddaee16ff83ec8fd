#pragma once
// Triangles of the proxies impostors are drawn on.

#include <glm/glm.hpp>
#include <vector>

#include "protocol/impostor/object_proxy.h"

namespace mirage {

struct ProxyVertex {
  glm::vec3 position, normal;
  float parallax;  ///< object units, see ConvexHull
};

/// The unit cube from (0, 0, 0) to (1, 1, 1).
std::vector<ProxyVertex> cube_triangles(float parallax);
/// Object space; triangles without area are left out.
std::vector<ProxyVertex> hull_triangles(const ConvexHull& hull);
/// For drawing with parallax, object space: the hull, or without one the bounding box.
std::vector<ProxyVertex> warp_triangles(const ObjectDescription& object);

}  // namespace mirage

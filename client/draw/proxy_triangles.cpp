#include "client/draw/proxy_triangles.h"

namespace mirage {

std::vector<ProxyVertex> cube_triangles(float parallax) {
  std::vector<ProxyVertex> out;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      glm::vec3 normal(0);
      normal[axis] = side == 1 ? 1.0f : -1.0f;
      const int u = (axis + (side == 1 ? 1 : 2)) % 3, v = (axis + (side == 1 ? 2 : 1)) % 3;
      for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
        glm::vec3 p(0);
        p[axis] = static_cast<float>(side);
        p[u] = static_cast<float>(a);
        p[v] = static_cast<float>(b);
        out.push_back({p, normal, parallax});
      }
    }
  }
  return out;
}

std::vector<ProxyVertex> hull_triangles(const ConvexHull& hull) {
  std::vector<ProxyVertex> out;
  for (std::size_t i = 0; i + 2 < hull.indices.size(); i += 3) {
    const std::uint8_t* at = &hull.indices[i];
    const glm::vec3 a = hull.vertices[at[0]], b = hull.vertices[at[1]], c = hull.vertices[at[2]];
    const glm::vec3 n = glm::cross(b - a, c - a);
    const float length = glm::length(n);
    if (!(length > 0)) continue;
    for (int k = 0; k < 3; ++k) {
      const float parallax = hull.parallax.empty() ? 0.0f : hull.parallax[at[k]];
      out.push_back({hull.vertices[at[k]], n / length, parallax});
    }
  }
  return out;
}

std::vector<ProxyVertex> warp_triangles(const ObjectDescription& object) {
  if (!object.hull.indices.empty()) return hull_triangles(object.hull);
  std::vector<ProxyVertex> out = cube_triangles(box_parallax(object));
  for (ProxyVertex& v : out) v.position = glm::mix(object.box_min, object.box_max, v.position);
  return out;
}

}  // namespace mirage

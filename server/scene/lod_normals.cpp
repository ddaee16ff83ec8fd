#include "server/scene/lod_normals.h"

#include <algorithm>
#include <map>

namespace mirage {
namespace {

constexpr float kNearCorner = 0.75f;    // where a corner's normal is judged
constexpr float kSameShading = 0.985f;  // cosine of 10 degrees

}  // namespace

void restore_normals(const SurfaceTree& full, std::vector<Vertex>& vertices,
                     std::vector<std::uint32_t>& indices) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> copies;  // of a vertex, with other normals
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    const std::uint32_t corner[3] = {indices[t], indices[t + 1], indices[t + 2]};
    glm::vec3 p[3], n[3];
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = vertices[corner[k]].position;
      n[k] = vertices[corner[k]].normal;
    }
    const glm::vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
      const glm::vec3 inside = kNearCorner * p[k] + 0.5f * (1 - kNearCorner) * (p[a] + p[b]);
      const glm::vec3 shown = kNearCorner * n[k] + 0.5f * (1 - kNearCorner) * (n[a] + n[b]);
      const glm::vec3 right = full.shading_at(inside).normal;
      if (glm::dot(right, face) <= 0) continue;  // of another side
      if (glm::dot(shown, right) >= kSameShading * glm::length(shown)) continue;
      std::vector<std::uint32_t>& made = copies[corner[k]];
      auto at = std::find_if(made.begin(), made.end(), [&](std::uint32_t i) {
        return glm::dot(vertices[i].normal, right) >= kSameShading;
      });
      if (at == made.end()) {
        Vertex copy = vertices[corner[k]];
        copy.normal = right;
        made.push_back(static_cast<std::uint32_t>(vertices.size()));
        vertices.push_back(copy);
        at = made.end() - 1;
      }
      indices[t + k] = *at;
    }
  }
}

}  // namespace mirage

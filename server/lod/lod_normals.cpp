#include "server/lod/lod_normals.h"

#include <algorithm>
#include <map>

namespace mirage {
namespace {

constexpr float kNearCorner = 0.75f;   // place near a corner where its normal is judged
constexpr float kSameNormal = 0.985f;  // cosine of 10 degrees

constexpr std::size_t kChunkTriangles = 2'000;

glm::vec3 near_corner(const glm::vec3 (&v)[3], std::size_t k) {
  return kNearCorner * v[k] + 0.5f * (1 - kNearCorner) * (v[(k + 1) % 3] + v[(k + 2) % 3]);
}

// True if all corner normals agree with the face of the triangle, so no other side shades it.
bool shades_as_it_lies(const glm::vec3 (&normals)[3], const glm::vec3& face) {
  const float enough = kSameNormal * glm::length(face);
  return std::all_of(normals, normals + 3, [&](const glm::vec3& n) {
    return glm::dot(n, face) >= enough * glm::length(n);
  });
}

/// Returns, for each corner, the full surface's normal if the corner shades wrongly, else zero.
std::vector<glm::vec3> missing_normals(const FullSurface& full, const Level& level,
                                       const Workers& workers) {
  const std::vector<std::uint32_t>& indices = level.indices;
  std::vector<glm::vec3> out(indices.size(), glm::vec3(0));
  const auto one = [&](std::size_t t) {
    glm::vec3 p[3], n[3];
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = level.vertices[indices[t + k]].position;
      n[k] = level.vertices[indices[t + k]].normal;
    }
    const glm::vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (shades_as_it_lies(n, face)) return;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t near = full.places()[level.origin[indices[t + k]]];
      const glm::vec3 right = full.tree().shading_at(near_corner(p, k), near).normal;
      if (glm::dot(right, face) <= 0) continue;  // the normal belongs to another side
      const glm::vec3 shown = near_corner(n, k);
      if (glm::dot(shown, right) < kSameNormal * glm::length(shown)) out[t + k] = right;
    }
  };
  const std::size_t triangles = indices.size() / 3;
  workers.each((triangles + kChunkTriangles - 1) / kChunkTriangles, [&](std::size_t chunk) {
    const std::size_t end = std::min(triangles, (chunk + 1) * kChunkTriangles);
    for (std::size_t t = chunk * kChunkTriangles; t < end; ++t) one(3 * t);
  });
  return out;
}

}  // namespace

Level level_of(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices) {
  Level out;
  out.indices.reserve(indices.size());
  std::vector<std::uint32_t> place(vertices.size(), UINT32_MAX);
  for (const std::uint32_t i : indices) {
    if (place[i] == UINT32_MAX) {
      place[i] = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back(vertices[i]);
      out.origin.push_back(i);
    }
    out.indices.push_back(place[i]);
  }
  return out;
}

void restore_normals(const FullSurface& full, Level& level, const Workers& workers) {
  const std::vector<glm::vec3> missing = missing_normals(full, level, workers);
  auto& [vertices, indices, origin, count] = level;
  // copies of a vertex with other normals
  std::map<std::uint32_t, std::vector<std::uint32_t>> copies;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const glm::vec3& right = missing[i];
    if (right == glm::vec3(0)) continue;
    std::vector<std::uint32_t>& made = copies[indices[i]];
    auto at = std::find_if(made.begin(), made.end(), [&](std::uint32_t c) {
      return glm::dot(level.vertices[c].normal, right) >= kSameNormal;
    });
    if (at == made.end()) {
      Vertex copy = vertices[indices[i]];
      copy.normal = right;
      made.push_back(static_cast<std::uint32_t>(vertices.size()));
      vertices.push_back(copy);
      ++count;
      origin.push_back(origin[indices[i]]);
      at = made.end() - 1;
    }
    indices[i] = *at;
  }
}

}  // namespace mirage

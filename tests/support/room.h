#pragma once
// Room: one mesh that an eye can be in: the six sides of a box, seen from inside, two triangles
// each, and a ball of many triangles on its floor.

#include <cmath>

#include "server/scene/scene.h"

namespace mirage::test {

/// Half of the room's sides, m.
inline constexpr glm::vec3 kRoomHalf{4, 1.5f, 5};

inline void add_room_side(const glm::vec3& normal, Mesh& mesh) {
  const glm::vec3 u(normal.y, normal.z, normal.x), v = glm::cross(normal, u);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const glm::vec2& at :
       {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
    Vertex corner;
    corner.position = kRoomHalf * (-normal + at.x * u + at.y * v);
    corner.normal = normal;
    corner.uv0 = at;
    // Each corner has its own colour, so that anything drawn in the wrong place shows.
    corner.color = glm::u16vec4(20000 + 20000 * (at.x > 0), 20000 + 20000 * (at.y > 0),
                                normal.y != 0 ? 50000 : 15000, 65535);
    mesh.vertices.push_back(corner);
  }
  for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + k);
}

inline void add_room_ball(const glm::vec3& center, float radius, int bands, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int a = 0; a <= bands; ++a) {
    for (int b = 0; b <= 2 * bands; ++b) {
      const double t = M_PI * a / bands, p = M_PI * b / bands;
      Vertex vertex;
      vertex.normal = glm::vec3(std::sin(t) * std::cos(p), std::cos(t), -std::sin(t) * std::sin(p));
      vertex.position = center + radius * vertex.normal;
      vertex.color = glm::u16vec4(60000, 30000, 10000, 65535);
      mesh.vertices.push_back(vertex);
    }
  }
  const auto row = static_cast<std::uint32_t>(2 * bands + 1);
  for (std::uint32_t a = 0; a < static_cast<std::uint32_t>(bands); ++a) {
    for (std::uint32_t b = 0; b + 1 < row; ++b) {
      const std::uint32_t i = first + a * row + b, below = i + row;
      for (const std::uint32_t k : {i, below, i + 1, i + 1, below, below + 1})
        mesh.indices.push_back(k);
    }
  }
}

inline Mesh room_mesh() {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {1.0f, -1.0f}) {
      glm::vec3 normal(0);
      normal[axis] = sign;
      add_room_side(normal, mesh);
    }
  }
  add_room_ball({1.5f, -1, -2}, 0.5f, 24, mesh);
  mesh.primitives.push_back(
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0});
  return mesh;
}

/// Returns the room once, about the origin, with the eye in it.
inline Scene room_scene() {
  Scene scene;
  scene.name = "room";
  scene.materials.emplace_back();
  scene.materials[0].metallic = 0;
  scene.objects.push_back({"room", room_mesh()});
  scene.instances.emplace_back();
  scene.home = {{0, 0, 1.5}, {0, -0.2, -3}, 1, 1.4};
  return scene;
}

}  // namespace mirage::test

// Parts of large meshes: together they are the mesh, they are small and overlap, and the result is
// always the same.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <set>

#include "protocol/impostor/tile_key.h"
#include "server/prepare/cut_mesh.h"
#include "server/prepare/prepared_scene.h"
#include "tests/support/room.h"

namespace mirage::test {
namespace {

using Corner = std::array<float, 3>;
using Triangle = std::array<Corner, 3>;

Corner corner(const Mesh& mesh, std::size_t index) {
  const glm::vec3& p = mesh.vertices[mesh.indices[index]].position;
  return {p.x, p.y, p.z};
}

glm::dvec3 place(const Corner& c) { return {c[0], c[1], c[2]}; }

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> out;
  for (const Primitive& p : mesh.primitives) {
    for (std::uint32_t i = p.first_index; i < p.first_index + p.index_count; i += 3) {
      out.push_back({corner(mesh, i), corner(mesh, i + 1), corner(mesh, i + 2)});
    }
  }
  return out;
}

double area(const Triangle& t) {
  return 0.5 * glm::length(glm::cross(place(t[1]) - place(t[0]), place(t[2]) - place(t[0])));
}

double radius_of(const Mesh& mesh) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const Vertex& v : mesh.vertices) {
    low = glm::min(low, v.position);
    high = glm::max(high, v.position);
  }
  return 0.5 * double{glm::length(high - low)};
}

TEST(ServerParts, TogetherAreTheMesh) {
  const Mesh room = room_mesh();
  const std::vector<Mesh> parts = cut_mesh(room);
  ASSERT_GT(parts.size(), 100u);
  ASSERT_LE(parts.size(), kMostParts);
  std::map<Triangle, int> shown;
  for (const Mesh& part : parts) {
    for (const Triangle& t : triangles_of(part)) ++shown[t];
  }
  double whole = 0, cut = 0;
  for (const Triangle& t : triangles_of(room)) whole += area(t);
  std::size_t twice = 0;
  for (const auto& [triangle, times] : shown) {
    cut += area(triangle);
    twice += times > 1;
  }
  EXPECT_NEAR(cut, whole, 1e-4 * whole);
  EXPECT_GT(twice, shown.size() / 10) << "neighbours overlap";
}

TEST(ServerParts, AreSmall) {
  const Mesh room = room_mesh();
  for (const Mesh& part : cut_mesh(room)) {
    // An eighth of the room, and the triangles next to it on either side.
    EXPECT_LT(radius_of(part), 0.2 * radius_of(room));
  }
}

// An edge that only one of its triangles divides would leave a gap.
TEST(ServerParts, DivideEdgesOnBothSides) {
  std::map<std::set<Corner>, int> edges;
  std::set<Triangle> all;
  for (const Mesh& part : cut_mesh(room_mesh())) {
    for (const Triangle& t : triangles_of(part)) all.insert(t);
  }
  for (const Triangle& t : all) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[k] != t[(k + 1) % 3]) ++edges[{t[k], t[(k + 1) % 3]}];
    }
  }
  // The sides of the room meet at right angles, and each corner exists two or three times. Every
  // edge has two triangles.
  std::size_t open = 0;
  for (const auto& [edge, triangles] : edges) open += triangles < 2;
  EXPECT_EQ(open, 0u) << "of " << edges.size();
}

TEST(ServerParts, AreTheSameEveryTime) {
  const std::vector<Mesh> a = cut_mesh(room_mesh()), b = cut_mesh(room_mesh());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].indices, b[i].indices);
    ASSERT_EQ(a[i].vertices.size(), b[i].vertices.size());
    EXPECT_EQ(std::memcmp(a[i].vertices.data(), b[i].vertices.data(),
                          a[i].vertices.size() * sizeof(Vertex)),
              0);
  }
}

TEST(ServerParts, OfNothingOrOnePointAreNone) {
  EXPECT_TRUE(cut_mesh({}).empty());
  Mesh point;
  point.vertices.resize(3);
  point.indices = {0, 1, 2};
  point.primitives.push_back({PrimitiveKind::kTriangles, 0, 3, 0});
  EXPECT_TRUE(cut_mesh(point).empty());
}

// A huge triangle and a tiny one: dividing ends, and so does cutting.
TEST(ServerParts, StayFewWhereLengthsAreFarApart) {
  Mesh mesh;
  mesh.vertices.resize(6);
  const glm::vec3 at[] = {{0, 0, 0}, {1e6f, 0, 0},  {0, 1e6f, 0},
                          {0, 0, 0}, {1e-6f, 0, 0}, {0, 1e-6f, 0}};
  for (std::uint32_t i = 0; i < 6; ++i) {
    mesh.vertices[i].position = at[i];
    mesh.indices.push_back(i);
  }
  mesh.primitives.push_back({PrimitiveKind::kTriangles, 0, 6, 0});
  const std::vector<Mesh> parts = cut_mesh(mesh);
  EXPECT_GT(parts.size(), 10u);
  EXPECT_LE(parts.size(), kMostParts);
}

TEST(ServerParts, LieInTheirBoxesAndNameTheirInstance) {
  Scene room = room_scene();
  room.instances[0].world_from_object.position = {100, 20, -7};
  room.instances[0].world_from_object.rotation = glm::angleAxis(0.7f, glm::vec3(0, 1, 0));
  room.instances[0].world_from_object.scale = 3;
  const auto scene = prepare_scene(room).take();
  ASSERT_EQ(scene->grouping.cuts.size(), 1u);
  EXPECT_TRUE(scene->objects[0].cut);
  const std::vector<std::uint32_t> members = scene->members(0);
  ASSERT_EQ(members.size(), scene->parts.size());
  EXPECT_EQ(scene->grouping.roots, std::vector<std::uint32_t>{0});
  const Similarity& m = scene->scene.instances[0].world_from_object;
  for (const std::uint32_t id : members) {
    EXPECT_EQ(scene->parent(id), 0u);
    const InstanceGroup& part = *scene->group_of_instance(id);
    for (const Vertex& v : scene->parts[part.part].vertices) {
      const glm::dvec3 at =
          m.position + glm::dquat(m.rotation) * (glm::dvec3(v.position) * double{m.scale});
      const glm::dvec3 out = glm::abs(at - part.bounds.center) - glm::dvec3(part.bounds.half);
      EXPECT_LE(std::max({out.x, out.y, out.z}), 1e-12);
    }
  }
}

TEST(ServerParts, WhatIsUsedTwiceOrMovesOrIsBlendedStaysWhole) {
  Scene twice = room_scene();
  twice.instances.push_back(twice.instances[0]);
  twice.instances[1].world_from_object.position.x = 20;
  EXPECT_TRUE(prepare_scene(twice).take()->grouping.cuts.empty());
  Scene glass = room_scene();
  glass.materials[0].alpha_mode = AlphaMode::kBlend;
  glass.materials[0].base_color.a = 0.5f;
  EXPECT_TRUE(prepare_scene(glass).take()->grouping.cuts.empty());
}

}  // namespace
}  // namespace mirage::test

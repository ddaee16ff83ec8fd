// Seams: vertices that differ only by rounding are joined, others stay apart, and no level of
// detail opens a closed surface.
#include "server/lod/seams.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "server/lod/lod.h"

namespace mirage::test {
namespace {

std::vector<Vertex> vertices_at(const std::vector<glm::vec3>& positions) {
  std::vector<Vertex> out;
  for (const glm::vec3& p : positions) out.emplace_back().position = p;
  return out;
}

void close_seams(std::vector<Vertex>& vertices) {
  const std::vector<glm::vec3> closed = closed_positions(vertices);
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i].position = closed[i];
}

TEST(ServerSeams, JoinsWhatRoundingParted) {
  const float next = std::nextafter(0.7f, 1.0f);
  std::vector<Vertex> v = vertices_at(
      {{1, 0, 0}, {0.7f, 1, -0.5f}, {1, -2.4e-16f, 1e-20f}, {next, 1, -0.5f}, {1, 0, 0}});
  close_seams(v);
  EXPECT_EQ(v[2].position, v[0].position);
  EXPECT_EQ(v[3].position, v[1].position);
  EXPECT_EQ(v[4].position, v[0].position);
  EXPECT_EQ(v[1].position, glm::vec3(0.7f, 1, -0.5f)) << "the first of them stays";
}

TEST(ServerSeams, LetsBeWhatIsApart) {
  // A plate a millionth as thick as it is wide, with steps of a millionth on it.
  const std::vector<glm::vec3> apart = {{-1, 0, 0},        {1, 0, 0},      {1, 1e-6f, 0},
                                        {1, 1e-6f, 1},     {1, 0, 1},      {0, 0, 0},
                                        {1 - 1e-6f, 0, 0}, {0, 1e-12f, 0}, {0, 0, 1e-6f}};
  std::vector<Vertex> v = vertices_at(apart);
  close_seams(v);
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_EQ(v[i].position, apart[i]) << i;
}

TEST(ServerSeams, TheMirroredMeshIsJoinedLikewise) {
  std::vector<glm::vec3> all, mirrored;
  for (int i = 0; i < 4000; ++i) {
    const double turn = 6.283185307179586 * (i % 400) / 133, tilt = 0.1 * (i % 37);
    all.emplace_back(std::sin(turn), std::cos(turn) * std::sin(tilt), std::cos(tilt));
    mirrored.push_back(all.back() * glm::vec3(-1, 1, 1));
  }
  std::vector<Vertex> a = vertices_at(all), b = vertices_at(mirrored);
  close_seams(a);
  close_seams(b);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].position * glm::vec3(-1, 1, 1), b[i].position) << i;
  }
}

/// A dented ball with a seam from pole to pole; its meridians run from 0 to a whole turn.
Mesh ball(std::uint32_t rings, std::uint32_t sectors) {
  Mesh mesh;
  for (std::uint32_t r = 0; r <= rings; ++r) {
    for (std::uint32_t s = 0; s <= sectors; ++s) {
      const double theta = 3.141592653589793 * r / rings, phi = 6.283185307179586 * s / sectors;
      const double dent = 1 + 0.15 * std::sin(3 * phi) * std::sin(theta) * std::sin(theta);
      Vertex& v = mesh.vertices.emplace_back();
      v.normal = {std::sin(theta) * std::cos(phi), std::cos(theta),
                  std::sin(theta) * std::sin(phi)};
      v.position = static_cast<float>(dent) * v.normal;
      v.uv0 = {static_cast<float>(s), static_cast<float>(r)};
    }
  }
  for (std::uint32_t r = 0; r < rings; ++r) {
    for (std::uint32_t s = 0; s < sectors; ++s) {
      const std::uint32_t a = r * (sectors + 1) + s, b = a + 1, c = b + sectors + 1, d = c - 1;
      if (r > 0) mesh.indices.insert(mesh.indices.end(), {a, b, c});
      if (r + 1 < rings) mesh.indices.insert(mesh.indices.end(), {a, c, d});
    }
  }
  mesh.primitives = {
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0}};
  return mesh;
}

/// Returns the edges between two positions that are not used equally often in both directions.
std::size_t open_edges(const Mesh& mesh) {
  using End = std::array<float, 3>;
  std::map<std::pair<End, End>, int> turns;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 a = mesh.vertices[mesh.indices[t + k]].position;
      const glm::vec3 b = mesh.vertices[mesh.indices[t + (k + 1) % 3]].position;
      const End from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
      if (from < to) ++turns[{from, to}];
      if (to < from) --turns[{to, from}];
    }
  }
  std::size_t open = 0;
  for (const auto& [edge, sum] : turns) open += sum != 0;
  return open;
}

TEST(ServerSeams, LevelsOfDetailStayClosed) {
  const Mesh full = ball(24, 32);
  ASSERT_GT(open_edges(full), 0u) << "nothing to close";
  const std::vector<MeshLod> lods = build_lods(full, {Material{}}, {});
  ASSERT_GE(lods.size(), 2u);
  for (const MeshLod& lod : lods) EXPECT_EQ(open_edges(lod.mesh), 0u) << lod.error;
}

}  // namespace
}  // namespace mirage::test

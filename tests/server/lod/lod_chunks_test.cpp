// Large surfaces in chunks: as few triangles as requested, no crack between chunks, and an error
// that no vertex exceeds.
#include "server/lod/lod_chunks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "server/lod/lod.h"

namespace mirage {
namespace {

/// A bumpy ring of 2 * around * along triangles.
Part ring(std::uint32_t around, std::uint32_t along) {
  Part out;
  for (std::uint32_t y = 0; y < along; ++y) {
    for (std::uint32_t x = 0; x < around; ++x) {
      const double u = 2 * M_PI * x / around, v = 2 * M_PI * y / along;
      const double r = 0.4 + 0.01 * std::sin(9 * u) * std::sin(7 * v);
      Vertex& vertex = out.vertices.emplace_back();
      vertex.normal = {std::cos(u) * std::cos(v), std::sin(u), std::cos(u) * std::sin(v)};
      vertex.position =
          glm::vec3(std::cos(v), 0, std::sin(v)) + static_cast<float>(r) * vertex.normal;
      const std::uint32_t a = y * around + x, b = y * around + (x + 1) % around;
      const std::uint32_t down = (y + 1) % along * around;
      const std::uint32_t c = down + x, d = down + (x + 1) % around;
      out.indices.insert(out.indices.end(), {a, b, c, b, d, c});
    }
  }
  return out;
}

/// Returns the number of edges, by position, that do not have two triangles.
std::size_t torn_edges(const Part& part) {
  using Place = std::array<float, 3>;
  std::map<std::pair<Place, Place>, int> count;
  for (std::size_t i = 0; i < part.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 a = part.vertices[part.indices[i + k]].position;
      const glm::vec3 b = part.vertices[part.indices[i + (k + 1) % 3]].position;
      const Place from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
      ++count[std::minmax(from, to)];
    }
  }
  std::size_t torn = 0;
  for (const auto& [edge, triangles] : count) torn += triangles != 2;
  return torn;
}

TEST(ServerLodChunks, AreClosedFewAndWithinTheirError) {
  const Part full = ring(200, 100);
  ASSERT_EQ(torn_edges(full), 0u);
  constexpr double kAllowed = 0.01;
  const ChunkedStep step =
      simplify_in_chunks(full, full.triangles() / 3, kAllowed, false, Workers(), 3'000);
  EXPECT_LT(step.part.triangles(), full.triangles() * 45 / 100);
  EXPECT_EQ(torn_edges(step.part), 0u);
  EXPECT_EQ(torn_edges(step.shown), 0u);
  EXPECT_EQ(step.shown.indices.size(), step.part.indices.size());
  EXPECT_GT(step.error, 0);
  EXPECT_LE(step.error, kAllowed);
  const SurfaceTree tree(step.part.vertices, step.part.indices);
  double largest = 0;
  for (const Vertex& v : full.vertices) largest = std::max(largest, tree.distance(v.position, 1));
  EXPECT_LE(largest, step.error * 1.05) << "chunks are sampled";
  EXPECT_GT(largest, 0);
}

TEST(ServerLodChunks, AreTheSameFromAnyNumberOfThreads) {
  const Part full = ring(120, 60);
  const auto made = [&](const Workers& workers) {
    return simplify_in_chunks(full, full.triangles() / 3, 0.01, false, workers, 1'000);
  };
  const ChunkedStep one = made(Workers()), many = made(Workers(4));
  EXPECT_EQ(one.part.indices, many.part.indices);
  EXPECT_EQ(one.shown.indices, many.shown.indices);
  EXPECT_EQ(one.error, many.error);
  ASSERT_EQ(one.shown.vertices.size(), many.shown.vertices.size());
  for (std::size_t i = 0; i < one.shown.vertices.size(); ++i) {
    EXPECT_EQ(one.shown.vertices[i].position, many.shown.vertices[i].position);
    EXPECT_EQ(one.shown.vertices[i].normal, many.shown.vertices[i].normal);
  }
}

// Every triangle has its own vertices; what remains is joined where chunks meet, too.
TEST(ServerLodChunks, SoupCollapsesAndStaysClosed) {
  const Part smooth = ring(120, 60);
  Part soup;
  for (const std::uint32_t i : smooth.indices) {
    soup.indices.push_back(static_cast<std::uint32_t>(soup.vertices.size()));
    soup.vertices.push_back(smooth.vertices[i]);
  }
  ASSERT_TRUE(is_soup(soup));
  const ChunkedStep step =
      simplify_in_chunks(soup, soup.triangles() / 3, 0.01, true, Workers(), 2'000);
  EXPECT_LT(step.part.triangles(), soup.triangles() * 6 / 10);
  EXPECT_EQ(torn_edges(step.part), 0u);
}

// A chain of more than kLargeTriangles goes through chunks first, and then ends as any other.
TEST(ServerLodChunks, BeginTheChainOfALargeMesh) {
  const Part part = ring(700, 720);
  ASSERT_GT(part.triangles(), kLargeTriangles);
  Mesh mesh{part.vertices, part.indices, {}};
  mesh.primitives.push_back(
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(part.indices.size()), 0});
  const std::vector<MeshLod> lods = build_lods(mesh, {Material{}}, {}, Workers(2));
  ASSERT_GE(lods.size(), 5u);
  for (std::size_t i = 0; i < lods.size(); ++i) {
    const SurfaceTree tree(lods[i].mesh.vertices, lods[i].mesh.indices);
    double largest = 0;
    std::uint32_t near = 0;
    for (std::size_t k = 0; k < part.vertices.size(); k += 101) {
      largest = std::max(largest, tree.distance_above(largest, part.vertices[k].position, 1, near));
    }
    EXPECT_LE(largest, double{lods[i].error}) << i;
    if (i > 0) {
      EXPECT_LT(lods[i].mesh.indices.size(), lods[i - 1].mesh.indices.size() * 6 / 10) << i;
      EXPECT_GT(lods[i].error, lods[i - 1].error) << i;
    }
  }
  EXPECT_LT(lods.back().mesh.indices.size() / 3, 2'000u);
}

}  // namespace
}  // namespace mirage

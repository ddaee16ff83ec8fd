// Levels of detail: fewer triangles each, errors that brute force confirms, foliage that keeps
// cover.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "protocol/limits.h"
#include "server/scene/lod.h"
#include "server/scene/prepared_scene.h"
#include "server/scene/surface_distance.h"

namespace mirage::test {
namespace {

std::size_t triangles(const Mesh& mesh) {
  std::size_t n = 0;
  for (const Primitive& p : mesh.primitives) n += p.index_count / 3;
  return n;
}

double brute_distance(const glm::vec3& p, const Mesh& mesh, const Primitive& of) {
  float best2 = INFINITY;
  for (std::uint32_t i = 0; i + 2 < of.index_count; i += 3) {
    const std::uint32_t* t = &mesh.indices[of.first_index + i];
    const glm::vec3 d =
        closest_on_triangle(p, mesh.vertices[t[0]].position, mesh.vertices[t[1]].position,
                            mesh.vertices[t[2]].position) -
        p;
    best2 = std::min(best2, glm::dot(d, d));
  }
  return std::sqrt(double{best2});
}

double area(const Mesh& mesh, std::uint32_t material) {
  double sum = 0;
  for (const Primitive& p : mesh.primitives) {
    if (p.material != material) continue;
    for (std::uint32_t i = 0; i + 2 < p.index_count; i += 3) {
      const std::uint32_t* t = &mesh.indices[p.first_index + i];
      const glm::vec3 a = mesh.vertices[t[0]].position;
      sum += 0.5 * double{glm::length(glm::cross(mesh.vertices[t[1]].position - a,
                                                 mesh.vertices[t[2]].position - a))};
    }
  }
  return sum;
}

TEST(ServerLod, ClosestPointsOfATriangle) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  const auto point = [&] { return glm::vec3(any(random), any(random), any(random)); };
  for (int n = 0; n < 300; ++n) {
    const glm::vec3 a = point(), b = point(), c = point(), p = 2.0f * point();
    const float got = glm::length(closest_on_triangle(p, a, b, c) - p);
    float best = INFINITY;
    for (int i = 0; i <= 60; ++i) {
      for (int k = 0; k <= 60 - i; ++k) {
        const float u = static_cast<float>(i) / 60, v = static_cast<float>(k) / 60;
        best = std::min(best, glm::length(a + u * (b - a) + v * (c - a) - p));
      }
    }
    EXPECT_LE(got, best + 1e-5f);
    EXPECT_GE(got, best - 0.05f);
  }
}

TEST(ServerLod, TreeFindsTheNearest) {
  const auto scene = load_scene("builtin:knot?tubular=40&radial=12").take();
  const Mesh& mesh = scene->scene.objects[0].mesh;
  const SurfaceTree tree(mesh.vertices, mesh.indices);
  const Primitive all{PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()),
                      0};
  std::mt19937 random(4);
  std::uniform_real_distribution<float> any(-3, 3);
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 p(any(random), any(random), any(random));
    EXPECT_NEAR(tree.distance(p, 100), brute_distance(p, mesh, all), 1e-5);
  }
  EXPECT_NEAR(tree.distance(glm::vec3(50, 0, 0), 7), 7, 1e-6) << "no farther than asked for";
}

TEST(ServerLod, ErrorIsHonestAgainstBruteForce) {
  const auto scene = load_scene("builtin:knot?tubular=100&radial=16").take();
  const Mesh& full = scene->scene.objects[0].mesh;
  const std::vector<MeshLod> lods = build_lods(full, scene->scene.materials);
  ASSERT_GE(lods.size(), 3u);
  std::size_t before = triangles(full);
  float error = 0;
  for (const MeshLod& lod : lods) {
    EXPECT_LE(static_cast<double>(triangles(lod.mesh)), 0.85 * static_cast<double>(before));
    EXPECT_GE(lod.error, error) << "coarser is not nearer";
    EXPECT_EQ(lod.spread, 0);
    double worst = 0;
    for (const Vertex& v : full.vertices) {
      worst = std::max(worst, brute_distance(v.position, lod.mesh, lod.mesh.primitives[0]));
    }
    EXPECT_GT(worst, 0);
    EXPECT_LE(worst, lod.error);
    before = triangles(lod.mesh);
    error = lod.error;
  }
}

TEST(ServerLod, FoliageKeepsItsArea) {
  const auto scene = load_scene("builtin:forest?trees=4&clutter=1").take();
  const Mesh& full = scene->scene.objects[0].mesh;  // a tree: bark and leaf cards
  const std::vector<MeshLod> lods = build_lods(full, scene->scene.materials);
  ASSERT_GE(lods.size(), 2u);
  for (const MeshLod& lod : lods) {
    EXPECT_GT(lod.spread, 0);
    EXPECT_LT(lod.spread, 0.25f * scene->objects[0].radius);
    for (const Primitive& p : lod.mesh.primitives) {
      const Material& m = scene->scene.materials[p.material];
      if (m.alpha_mode != AlphaMode::kMask) continue;
      EXPECT_NEAR(area(lod.mesh, p.material) / area(full, p.material), 1.0, 0.15);
    }
  }
}

TEST(ServerLod, PrimitivesKeepTheirMaterialAndLinesStay) {
  const auto knot = load_scene("builtin:knot?tubular=100&radial=16").take();
  Mesh mesh = knot->scene.objects[0].mesh;
  const auto half = static_cast<std::uint32_t>(mesh.indices.size() / 6 * 3);
  const auto rest = static_cast<std::uint32_t>(mesh.indices.size()) - half;
  mesh.primitives = {{PrimitiveKind::kTriangles, 0, half, 0},
                     {PrimitiveKind::kTriangles, half, rest, 1},
                     {PrimitiveKind::kLines, 0, 10, 2}};
  const std::vector<MeshLod> lods = build_lods(mesh, std::vector<Material>(3));
  ASSERT_FALSE(lods.empty());
  for (const MeshLod& lod : lods) {
    ASSERT_EQ(lod.mesh.primitives.size(), 3u);
    for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(lod.mesh.primitives[i].material, i);
    const Primitive& lines = lod.mesh.primitives[2];
    EXPECT_EQ(lines.kind, PrimitiveKind::kLines);
    ASSERT_EQ(lines.index_count, 10u);
    for (std::uint32_t i = 0; i < 10; ++i) {
      EXPECT_EQ(lod.mesh.vertices[lod.mesh.indices[lines.first_index + i]].position,
                mesh.vertices[mesh.indices[i]].position);
    }
    // Each part's vertices come from that part.
    for (std::uint32_t part = 0; part < 2; ++part) {
      const Primitive& p = lod.mesh.primitives[part];
      for (std::uint32_t i = 0; i < p.index_count; ++i) {
        EXPECT_LT(brute_distance(lod.mesh.vertices[lod.mesh.indices[p.first_index + i]].position,
                                 mesh, mesh.primitives[part]),
                  1e-5);
      }
    }
  }
}

// Flat-shaded scans give every triangle three vertices of its own.
TEST(ServerLod, TriangleSoupIsSimplifiedToo) {
  const auto knot = load_scene("builtin:knot?tubular=200&radial=16").take();
  const Mesh& smooth = knot->scene.objects[0].mesh;
  Mesh soup;
  for (const std::uint32_t i : smooth.indices) {
    soup.indices.push_back(static_cast<std::uint32_t>(soup.vertices.size()));
    Vertex v = smooth.vertices[i];
    v.uv0 = v.uv1 = glm::vec2(0);
    v.normal = glm::normalize(v.normal + 0.01f * static_cast<float>(soup.indices.size() % 7));
    soup.vertices.push_back(v);
  }
  soup.primitives = {
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(soup.indices.size()), 0}};
  const std::vector<MeshLod> lods = build_lods(soup, std::vector<Material>(1));
  ASSERT_GE(lods.size(), 2u);
  EXPECT_LT(triangles(lods.back().mesh), triangles(soup) / 8);
}

TEST(ServerLod, TheSameOnEveryRun) {
  const auto scene = load_scene("builtin:forest?trees=4&clutter=1").take();
  const auto again = load_scene("builtin:forest?trees=4&clutter=1").take();
  EXPECT_EQ(scene->revision, again->revision);
  for (std::size_t i = 0; i < scene->geometry.size(); ++i) {
    ASSERT_EQ(scene->geometry[i].encoded.size(), again->geometry[i].encoded.size());
    for (std::size_t k = 0; k < scene->geometry[i].encoded.size(); ++k) {
      EXPECT_EQ(scene->geometry[i].encoded[k].payload, again->geometry[i].encoded[k].payload);
    }
  }
}

TEST(ServerLod, TilesUseBoundedLevelsOnly) {
  const Capture far(ViewCell{4, 3, 3}, DistanceBucket{2, 40}, 1.0, 64);
  const double allowed = 0.25 * far.texel_width(far.distance - 1.0);
  const auto fits = static_cast<float>(0.9 * allowed), too_far = static_cast<float>(1.1 * allowed);
  EXPECT_EQ(lod_for_tile({{9, 9, 0, 0}, {5, 5, fits, 0}, {2, 2, too_far, 0}}, far), 1u);
  EXPECT_EQ(lod_for_tile({{9, 9, 0, 0}, {5, 5, fits, 0}, {2, 2, fits, 0}}, far), 2u);
  EXPECT_EQ(lod_for_tile({{9, 9, 0, 0}, {5, 5, 0, 0.001f}}, far), 0u) << "thinned: no bound";
  EXPECT_EQ(tile_lod_error({{9, 9, 0.5f, 0}, {5, 5, too_far, 0}}, far), 0) << "the whole mesh";
  EXPECT_EQ(tile_lod_error({{9, 9, 0, 0}, {5, 5, fits, 0}}, far), fits);
  EXPECT_EQ(lod_for_tile({}, far), 0u);
}

}  // namespace
}  // namespace mirage::test

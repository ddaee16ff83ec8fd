// Levels of detail: each has fewer triangles, an error that brute force confirms, and foliage that
// keeps its cover.
#include "server/lod/lod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "protocol/base/limits.h"
#include "server/lod/surface_distance.h"
#include "server/prepare/prepared_scene.h"

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
  const std::vector<MeshLod> lods = build_lods(full, scene->scene.materials, scene->scene.images);
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
  const std::vector<MeshLod> lods = build_lods(full, scene->scene.materials, scene->scene.images);
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

/// 400 copies of some triangles, 0.1 apart on a square.
Mesh meadow(const std::vector<glm::vec3>& corners) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const glm::vec3 foot(0.1f * static_cast<float>(i % 20), 0, 0.1f * static_cast<float>(i / 20));
    for (const glm::vec3& corner : corners) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.emplace_back().position = foot + corner;
    }
  }
  mesh.primitives = {
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0}};
  return mesh;
}

std::vector<Material> double_sided_material() {
  std::vector<Material> materials(1);
  materials[0].double_sided = true;
  return materials;
}

TEST(ServerLod, BladesGrowBroaderNotLonger) {
  const Mesh mesh = meadow({{0, 0, 0}, {0.02f, 0, 0}, {0, 2, 0}});
  const std::vector<MeshLod> lods = build_lods(mesh, double_sided_material(), {});
  ASSERT_GE(lods.size(), 2u);
  for (const MeshLod& lod : lods) {
    EXPECT_NEAR(area(lod.mesh, 0), area(mesh, 0), 0.01 * area(mesh, 0));
    for (const Vertex& v : lod.mesh.vertices) {
      EXPECT_GT(v.position.y, -0.02f);
      EXPECT_LT(v.position.y, 2.02f);
    }
  }
  EXPECT_LT(lods[0].spread, 0.3) << "a third of the blades, each three times as broad";
  EXPECT_GE(lods[1].spread, 0.02 * 9) << "no more than the width of its blades may be seen to move";
}

TEST(ServerLod, LumpsAreNotEnlargedUnseen) {
  const glm::vec3 a(1, 1, 1), b(1, -1, -1), c(-1, 1, -1), d(-1, -1, 1);
  const Mesh mesh = meadow({a, b, c, a, d, b, a, c, d, b, d, c});
  const std::vector<MeshLod> lods = build_lods(mesh, double_sided_material(), {});
  ASSERT_FALSE(lods.empty());
  EXPECT_GT(lods[0].spread, 0.7) << "a third of the lumps, each 1.7 times as large";
}

/// A cube of edge 2 whose edges are rounded with a radius of 0.02.
Mesh bevelled_cube() {
  std::vector<float> grid;
  for (int i = 0; i <= 6; ++i) grid.push_back(-1 + 0.02f * static_cast<float>(i) / 6);
  for (int i = 1; i < 8; ++i) grid.push_back(-0.98f + 1.96f * static_cast<float>(i) / 8);
  for (int i = 0; i <= 6; ++i) grid.push_back(0.98f + 0.02f * static_cast<float>(i) / 6);
  const auto n = static_cast<std::uint32_t>(grid.size());
  Mesh mesh;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const float side = face % 2 ? 1.0f : -1.0f;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i < n * n; ++i) {
      glm::vec3 p;
      p[axis] = side;
      p[(axis + 1) % 3] = grid[i % n] * side;
      p[(axis + 2) % 3] = grid[i / n];
      const glm::vec3 inner = glm::clamp(p, -0.98f, 0.98f);
      Vertex v;
      v.normal = glm::normalize(p - inner);
      v.position = inner + 0.02f * v.normal;
      mesh.vertices.push_back(v);
    }
    for (std::uint32_t y = 0; y + 1 < n; ++y) {
      for (std::uint32_t x = 0; x + 1 < n; ++x) {
        const std::uint32_t a = first + y * n + x;
        for (const std::uint32_t i : {a, a + 1, a + n + 1, a, a + n + 1, a + n}) {
          mesh.indices.push_back(i);
        }
      }
    }
  }
  mesh.primitives = {
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0}};
  return mesh;
}

/// Returns the share of the area that is shaded as if it leaned by more than 20 degrees.
double leaning_share(const Mesh& mesh) {
  double wrong = 0, whole = 0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const Vertex* v[3];
    for (std::size_t k = 0; k < 3; ++k) v[k] = &mesh.vertices[mesh.indices[t + k]];
    const glm::vec3 cross =
        glm::cross(v[1]->position - v[0]->position, v[2]->position - v[0]->position);
    const double size = 0.5 * double{glm::length(cross)};
    if (!(size > 1e-4)) continue;  // remains of the bevels
    for (const glm::vec3& w :
         {glm::vec3(0.8f, 0.1f, 0.1f), glm::vec3(0.1f, 0.8f, 0.1f), glm::vec3(0.1f, 0.1f, 0.8f)}) {
      const glm::vec3 n =
          glm::normalize(w.x * v[0]->normal + w.y * v[1]->normal + w.z * v[2]->normal);
      whole += size;
      if (glm::dot(n, glm::normalize(cross)) < 0.94f) wrong += size;
    }
  }
  return wrong / whole;
}

TEST(ServerLod, FacesStayFlatWhenTheirBevelsCollapse) {
  const Mesh cube = bevelled_cube();
  ASSERT_LT(leaning_share(cube), 0.02);
  const std::vector<MeshLod> lods = build_lods(cube, {Material{}}, {});
  ASSERT_GE(lods.size(), 2u);
  ASSERT_LT(triangles(lods.back().mesh), triangles(cube) / 10);
  for (const MeshLod& lod : lods) EXPECT_LT(leaning_share(lod.mesh), 0.02);
}

TEST(ServerLod, ColoursOfVerticesAreNotLostWithThem) {  // light baked into a wall
  Mesh wall = bevelled_cube();
  for (Vertex& v : wall.vertices) {
    const float dark = glm::length(v.position) / 1.74f;  // towards the corners
    const auto level = static_cast<std::uint16_t>(65535.0f * (1 - 0.8f * dark * dark));
    v.color = {level, level, level, 65535};
  }
  for (const MeshLod& lod : build_lods(wall, {Material{}}, {})) {
    const SurfaceTree tree(lod.mesh.vertices, lod.mesh.indices);
    double wrong = 0;
    for (const Vertex& v : wall.vertices) {
      const float shown = tree.shading_at(v.position).color.x;
      wrong +=
          std::abs(std::sqrt(shown) - std::sqrt(static_cast<float>(v.color.x) / 65535.0f)) > 0.05f;
    }
    EXPECT_LT(wrong / static_cast<double>(wall.vertices.size()), 0.03);
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
  const std::vector<MeshLod> lods = build_lods(mesh, std::vector<Material>(3), {});
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
    // The vertices of each part come from that part.
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
  const std::vector<MeshLod> lods = build_lods(soup, std::vector<Material>(1), {});
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

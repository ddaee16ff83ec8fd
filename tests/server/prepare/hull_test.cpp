// Enclosing hulls and object descriptions: they must really enclose, because the bound relies on
// it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "protocol/base/limits.h"
#include "server/prepare/convex_hull.h"
#include "server/prepare/prepared_scene.h"

namespace mirage::test {
namespace {

/// Returns the solid angle, in full spheres, that the triangles cover as seen from a point: 1
/// inside a closed surface that winds outward, 0 outside (van Oosterom and Strackee, "The solid
/// angle of a plane triangle", 1983). It holds for slivers, whose own planes lean by the rounding
/// of their corners.
double spheres_around(const glm::dvec3& point, const ConvexHull& hull) {
  double sum = 0;
  for (std::size_t i = 0; i + 2 < hull.indices.size(); i += 3) {
    const glm::dvec3 a = glm::dvec3(hull.vertices[hull.indices[i]]) - point;
    const glm::dvec3 b = glm::dvec3(hull.vertices[hull.indices[i + 1]]) - point;
    const glm::dvec3 c = glm::dvec3(hull.vertices[hull.indices[i + 2]]) - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc +
                                                         glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (2 * glm::pi<double>());
}

/// Returns how many points are outside the hull's surface, or outside one of its planes.
std::ptrdiff_t outside(const ConvexHull& hull, const std::vector<glm::vec3>& points) {
  const std::vector<Plane> planes = hull.planes();
  return std::count_if(points.begin(), points.end(), [&](const glm::dvec3& p) {
    return spheres_around(p, hull) < 0.9 ||
           std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) {
             return glm::dot(plane.normal, p) > plane.offset;
           });
  });
}

/// Signed volume: positive when triangles wind outward.
double volume(const ConvexHull& hull) {
  double sum = 0;
  const glm::dvec3 origin(hull.vertices.at(0));
  for (std::size_t i = 0; i + 2 < hull.indices.size(); i += 3) {
    const glm::dvec3 a = glm::dvec3(hull.vertices[hull.indices[i]]) - origin;
    const glm::dvec3 b = glm::dvec3(hull.vertices[hull.indices[i + 1]]) - origin;
    const glm::dvec3 c = glm::dvec3(hull.vertices[hull.indices[i + 2]]) - origin;
    sum += glm::dot(a, glm::cross(b, c)) / 6;
  }
  return sum;
}

/// True if every edge is used once in each direction.
bool is_closed(const ConvexHull& hull) {
  std::vector<std::pair<int, int>> edges;
  for (std::size_t i = 0; i + 2 < hull.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges.emplace_back(hull.indices[i + k], hull.indices[i + (k + 1) % 3]);
    }
  }
  for (const auto& [a, b] : edges) {
    if (std::count(edges.begin(), edges.end(), std::pair{a, b}) != 1) return false;
    if (std::count(edges.begin(), edges.end(), std::pair{b, a}) != 1) return false;
  }
  return !edges.empty();
}

void expect_encloses(const std::vector<glm::vec3>& points, const std::string& what) {
  const Result<ConvexHull> hull = enclosing_hull(points);
  ASSERT_TRUE(hull) << what << ": " << hull.error().text;
  EXPECT_LE(hull->vertices.size(), limits::kMaxHullVertices) << what;
  EXPECT_LE(hull->indices.size(), limits::kMaxHullTriangles * 3) << what;
  EXPECT_EQ(outside(*hull, points), 0) << what;
  EXPECT_GT(volume(*hull), 0) << what;
  EXPECT_TRUE(is_closed(*hull)) << what;
  for (const glm::vec3& v : hull->vertices) {
    EXPECT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) << what;
  }
}

std::vector<glm::vec3> cloud(std::mt19937& random, int n, const glm::vec3& size,
                             const glm::vec3& offset) {
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<glm::vec3> out;
  for (int i = 0; i < n; ++i) {
    out.push_back(offset + size * glm::vec3(unit(random), unit(random), unit(random)));
  }
  return out;
}

TEST(ServerHull,
     HasAParallaxFactorForEveryVertex) {  // clients refuse hulls with fewer
  const Result<ConvexHull> hull = enclosing_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  ASSERT_TRUE(hull.ok());
  EXPECT_GT(hull->vertices.size(), 0u);
  EXPECT_EQ(hull->parallax, std::vector<float>(hull->vertices.size(), 0.0f));
}

TEST(ServerHull, EnclosesRandomClouds) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> exponent(-3, 3);
  for (int i = 0; i < 300; ++i) {
    const auto size = static_cast<float>(std::pow(10.0, exponent(random)));
    const int n = 2 + static_cast<int>(random() % 200);
    expect_encloses(cloud(random, n, glm::vec3(size), glm::vec3(size * 3)),
                    "cloud " + std::to_string(i));
  }
}

TEST(ServerHull, EnclosesNeedlesAndSheets) {
  std::mt19937 random(7);
  for (int i = 0; i < 100; ++i) {
    expect_encloses(cloud(random, 50, {1, 1e-4f, 1}, glm::vec3(0)), "sheet");
    expect_encloses(cloud(random, 50, {1e-4f, 1, 1e-4f}, glm::vec3(2)), "needle");
  }
}

TEST(ServerHull, EnclosesFarFromTheOrigin) {
  // Corners are float. From 1e4 m on, their rounding exceeds the growth of an object of a metre.
  std::mt19937 random(8);
  for (const float offset : {10.f, 100.f, 300.f, 3000.f}) {
    for (int i = 0; i < 200; ++i) {
      expect_encloses(cloud(random, 100, glm::vec3(1), glm::vec3(offset, 0, -offset)),
                      "at " + std::to_string(offset));
    }
  }
}

TEST(ServerHull, FlatLineAndSinglePoint) {
  expect_encloses({{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, "square");
  expect_encloses({{0, 0, 0}, {1, 0.5f, 0.25f}, {1, 0.5f, 0.75f}}, "triangle");
  expect_encloses({{0, 0, 0}, {3, 2, 1}}, "line");
  expect_encloses({{0, 0, 0}, {0, 5, 0}, {0, 2, 0}}, "line on an axis");
  const Result<ConvexHull> empty = enclosing_hull({});
  ASSERT_TRUE(empty);
  EXPECT_TRUE(empty->vertices.empty());
  // A point has no extent to grow by: it gives no body, but no error either.
  const Result<ConvexHull> point = enclosing_hull({{1, 2, 3}, {1, 2, 3}});
  ASSERT_TRUE(point) << point.error().text;
  for (const glm::vec3& v : point->vertices) {
    EXPECT_NEAR(glm::length(v - glm::vec3(1, 2, 3)), 0, 1e-5);
  }
}

TEST(ServerHull, ParallaxIsTheDistanceToTheNearestPointBehind) {
  ConvexHull hull;
  hull.vertices = {{0, 0, 4}, {3, 0, 0}, {0, -2, 0}};
  const std::vector<glm::vec3> points = {{0, 0, 1}, {0, 0, 4.5f}, {1, 0, 0}};
  // The second point is nearer to the first vertex but in front of it.
  EXPECT_EQ(parallax_factors(hull, points, glm::vec3(0)),
            (std::vector<float>{3, 2, std::sqrt(5.0f)}));
  EXPECT_EQ(parallax_factors(hull, {}, glm::vec3(0)), (std::vector<float>{0, 0, 0}));
}

TEST(ServerHull, KnotLiesBehindItsHullByTheFactors) {
  const auto scene = load_scene("builtin:knot?tubular=24&radial=8");
  ASSERT_TRUE(scene) << scene.error().text;
  const ObjectDescription& o = (*scene)->objects[0];
  ASSERT_EQ(o.hull.parallax.size(), o.hull.vertices.size());
  for (std::size_t i = 0; i < o.hull.vertices.size(); ++i) {
    const glm::vec3 corner = o.hull.vertices[i];
    float nearest = 2 * o.radius;
    for (const Vertex& v : (*scene)->scene.objects[0].mesh.vertices) {
      const bool behind = glm::dot(v.position - corner, o.center - corner) >= 0;
      if (behind) nearest = std::min(nearest, glm::length(v.position - corner));
    }
    EXPECT_FLOAT_EQ(o.hull.parallax[i], nearest);
    EXPECT_GT(o.hull.parallax[i], 0);
    EXPECT_LT(o.hull.parallax[i], o.radius);
  }
}

TEST(ServerHull, DescriptionContainsEveryVertexInUse) {
  for (const char* spec : {"builtin:knot?tubular=24&radial=8", "builtin:clutter?objects=20"}) {
    const auto scene = load_scene(spec);
    ASSERT_TRUE(scene) << scene.error().text;
    for (std::size_t i = 0; i < (*scene)->objects.size(); ++i) {
      const ObjectDescription& o = (*scene)->objects[i];
      const Mesh& mesh = (*scene)->scene.objects[i].mesh;
      std::vector<glm::vec3> points;
      for (const std::uint32_t index : mesh.indices) {
        const glm::vec3 p = mesh.vertices[index].position;
        points.push_back(p);
        ASSERT_LE(glm::length(glm::dvec3(p) - glm::dvec3(o.center)), double{o.radius});
        ASSERT_TRUE(glm::all(glm::lessThanEqual(o.box_min, p)));
        ASSERT_TRUE(glm::all(glm::greaterThanEqual(o.box_max, p)));
      }
      ASSERT_FALSE(o.hull.vertices.empty());
      EXPECT_EQ(outside(o.hull, points), 0);
    }
  }
}

TEST(ServerHull, DescriptionOfNothing) {
  Scene scene;
  scene.materials.emplace_back();
  scene.objects.emplace_back();
  const ObjectDescription nothing = describe_object(scene.objects[0], scene);
  EXPECT_EQ(nothing.radius, 0);
  EXPECT_TRUE(nothing.hull.vertices.empty());
  // All vertices are in one place: a little extent avoids a division by zero later.
  SceneObject& object = scene.objects[0];
  object.mesh.vertices.resize(3);
  for (Vertex& v : object.mesh.vertices) v.position = {4, 5, 6};
  object.mesh.indices = {0, 1, 2};
  object.mesh.primitives.push_back({PrimitiveKind::kTriangles, 0, 3, 0});
  const ObjectDescription point = describe_object(object, scene);
  EXPECT_GT(point.radius, 0);
  EXPECT_TRUE(std::isfinite(point.radius));
}

TEST(ServerHull, VerticesNothingUsesAreLeftOut) {
  Scene scene;
  scene.materials.emplace_back();
  scene.objects.emplace_back();
  Mesh& mesh = scene.objects[0].mesh;
  mesh.vertices.resize(4);
  mesh.vertices[1].position = {1, 0, 0};
  mesh.vertices[2].position = {0, 1, 0};
  mesh.vertices[3].position = {1e6f, 0, 0};
  mesh.indices = {0, 1, 2};
  mesh.primitives.push_back({PrimitiveKind::kTriangles, 0, 3, 0});
  EXPECT_LT(describe_object(scene.objects[0], scene).radius, 1);
}

/// Returns the description of squares of edge 2: each is the square at z = 1 that faces +z, turned
/// about the origin.
ObjectDescription squares(const std::vector<glm::quat>& turns, bool double_sided = false) {
  Scene scene;
  scene.materials.emplace_back().double_sided = double_sided;
  Mesh& mesh = scene.objects.emplace_back().mesh;
  for (const glm::quat& turn : turns) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const glm::vec3& corner :
         {glm::vec3(-1, -1, 1), glm::vec3(1, -1, 1), glm::vec3(1, 1, 1), glm::vec3(-1, 1, 1)}) {
      mesh.vertices.emplace_back().position = turn * corner;
    }
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
  }
  mesh.primitives.push_back(
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0});
  return describe_object(scene.objects[0], scene);
}

bool seen_from(const ObjectDescription& object, const glm::dvec3& eye) {
  return !faces_away(object, eye - glm::dvec3(object.center));
}

TEST(ServerHull, AnObjectIsNotSeenFromBehindAllItsFaces) {
  const auto turned = [](int quarters) {
    const float angle = glm::half_pi<float>() * static_cast<float>(quarters);
    return glm::angleAxis(angle, glm::vec3(0, 1, 0));
  };
  const ObjectDescription square = squares({turned(0)});
  EXPECT_TRUE(seen_from(square, {0, 0, 3}));
  EXPECT_TRUE(seen_from(square, {50, 0, 1.1}));
  EXPECT_FALSE(seen_from(square, {0, 0, 0.9}));
  EXPECT_FALSE(seen_from(square, {50, 50, 0}));
  EXPECT_TRUE(seen_from(squares({turned(0)}, true), {0, 0, -3})) << "both sides are drawn";
  const ObjectDescription corner = squares({turned(0), turned(1)});  // faces +z and +x
  EXPECT_TRUE(seen_from(corner, {0, 0, 5}));
  EXPECT_TRUE(seen_from(corner, {-5, 0, 3})) << "behind one, before the other";
  EXPECT_FALSE(seen_from(corner, {-5, 0, -5}));
  const ObjectDescription ring = squares({turned(0), turned(1), turned(2), turned(3)});
  for (const glm::dvec3& eye : {glm::dvec3(0), glm::dvec3(0, 0, -4), glm::dvec3(0, 9, 0)}) {
    EXPECT_TRUE(seen_from(ring, eye)) << "some face looks anywhere";
  }
}

TEST(PrepareObject, ALongNameIsCutBetweenTwoCharacters) {
  Scene scene;
  SceneObject object;
  object.name = "oak";
  EXPECT_EQ(describe_object(object, scene).name, "oak");
  const std::string fitting(limits::kMaxObjectNameBytes - 1, 'a');
  for (const char* letter : {"\u00e4", "b"}) {
    object.name = fitting;
    for (int i = 0; i < 2; ++i) object.name += letter;
    const bool one_byte = letter[1] == 0;
    EXPECT_EQ(describe_object(object, scene).name, one_byte ? fitting + letter : fitting);
  }
}

}  // namespace
}  // namespace mirage::test

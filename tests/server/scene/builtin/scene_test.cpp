// Layout, determinism and counts of the built-in scenes.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "server/scene/builtin/builtin_scene.h"

namespace mirage {
namespace {

Scene built(const std::string& spec) {
  auto scene = build_builtin_scene(spec);
  EXPECT_TRUE(scene.ok()) << spec;
  return scene.ok() ? scene.take() : Scene();
}

template <typename T>
void append(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// Everything a client could see, without padding bytes.
std::string fingerprint(const Scene& scene) {
  std::string bytes;
  for (const SceneObject& object : scene.objects) {
    bytes += object.name;
    append(bytes, object.mesh.vertices);
    append(bytes, object.mesh.indices);
  }
  for (const Image& image : scene.images) append(bytes, image.rgba);
  for (const Instance& i : scene.instances) {
    const Similarity& s = i.world_from_object;
    append(bytes, std::vector<double>{static_cast<double>(i.object), s.position.x, s.position.y,
                                      s.position.z, s.rotation.w, s.rotation.y, s.scale});
  }
  return bytes;
}

TEST(BuiltinScene, SameSpecSameBytesOtherSeedDiffers) {
  for (const std::string spec : {"forest?trees=30", "clutter?objects=80", "city?blocks=2",
                                 "field?instances=500", "museum?objects=12&triangles=2000"}) {
    const std::string first = fingerprint(built(spec));
    EXPECT_TRUE(first == fingerprint(built(spec))) << spec;
    EXPECT_FALSE(first == fingerprint(built(spec + "&seed=2"))) << spec;
  }
}

TEST(BuiltinScene, TreesHaveTenThousandTrianglesOrMore) {
  EXPECT_EQ(built("forest?trees=30&fog=0.02").environment.fog_density, 0.02f);
  const Scene scene = built("forest?trees=400&species=8&clutter=0");
  EXPECT_EQ(scene.instances.size(), 402u);  // and terrain and pond
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t triangles = scene.objects[i].mesh.indices.size() / 3;
    EXPECT_GE(triangles, 10000u) << scene.objects[i].name;
    EXPECT_LE(triangles, 20000u) << scene.objects[i].name;
  }
  EXPECT_GE(scene.triangles(), 4'000'000u);
}

TEST(BuiltinScene, CountsFollowTheOptions) {
  EXPECT_EQ(built("clutter").instances.size(), 304u);  // and the room and three pendant lamps
  EXPECT_EQ(built("clutter?objects=1").instances.size(), 5u);
  EXPECT_EQ(built("field?instances=12345").instances.size(), 12346u);
  EXPECT_EQ(built("knot").instances.size(), 1u);
  EXPECT_GT(built("city?blocks=3").instances.size(), built("city?blocks=1").instances.size());
  std::set<std::string> kinds;
  for (const SceneObject& object : built("clutter").objects) kinds.insert(object.name);
  EXPECT_GE(kinds.size(), 14u);
}

TEST(BuiltinScene, InstancesAreSimilarities) {
  for (const std::string spec : {"forest?trees=100", "clutter", "city", "field?instances=100",
                                 "museum?objects=12&triangles=2000"}) {
    const Scene scene = built(spec);
    for (const Instance& i : scene.instances) {
      const Similarity& s = i.world_from_object;
      ASSERT_LT(i.object, scene.objects.size());
      ASSERT_GT(s.scale, 0);
      ASSERT_NEAR(glm::dot(s.rotation, s.rotation), 1, 1e-5);
      ASSERT_TRUE(std::isfinite(glm::dot(s.position, s.position)));
    }
  }
}

bool surrounds(const std::string& name) {
  return name == "terrain" || name == "pond" || name == "room" || name == "ground" ||
         name == "meadow" || name == "hall" || name == "hall floor";
}

/// Returns the least horizontal distance from the walk loop to a vertex that a walker could run
/// into.
double clearance(const Scene& scene) {
  const HomeView& home = scene.home;
  const glm::dvec3 f =
      glm::normalize(glm::dvec3(home.target.x - home.eye.x, 0, home.target.z - home.eye.z));
  const glm::dvec2 center(home.eye.x - f.z * home.walk_radius_m,
                          home.eye.z + f.x * home.walk_radius_m);
  double least = 1e9;
  for (const Instance& i : scene.instances) {
    const SceneObject& object = scene.objects[i.object];
    if (surrounds(object.name)) continue;
    const Similarity& s = i.world_from_object;
    for (const Vertex& v : object.mesh.vertices) {
      const glm::dvec3 p = s.position + glm::dvec3(s.rotation * (v.position * s.scale));
      if (p.y < 0 || p.y > home.eye.y + 0.15) continue;
      const double r = glm::length(glm::dvec2(p.x, p.z) - center);
      least = std::min(least, std::abs(r - home.walk_radius_m));
    }
  }
  return least;
}

TEST(BuiltinScene, WalkLoopIsFree) {
  EXPECT_GT(clearance(built("forest?trees=400&species=8&seed=3")), 0.5);
  EXPECT_GT(clearance(built("clutter")), 0.25);
  EXPECT_GT(clearance(built("city?blocks=3")), 0.8);
  EXPECT_GT(clearance(built("city?blocks=1")), 0.8);
  EXPECT_GT(clearance(built("field?instances=1000")), 0.3);
  EXPECT_GT(clearance(built("museum?objects=60&triangles=2000")), 1.2);
  EXPECT_GT(clearance(built("museum?objects=1&triangles=2000")), 1.2);
}

TEST(BuiltinScene, ForestGroundIsLevelAlongTheWalk) {
  const Scene scene = built("forest?trees=400&clutter=0");
  int seen = 0;
  for (const SceneObject& object : scene.objects) {
    if (object.name != "terrain") continue;
    for (const Vertex& v : object.mesh.vertices) {
      const float r = glm::length(glm::vec2(v.position.x, v.position.z));
      if (std::abs(r - 20) > 4) continue;
      ++seen;
      EXPECT_NEAR(v.position.y, 0, 1e-4);
    }
  }
  EXPECT_GT(seen, 100);
  EXPECT_DOUBLE_EQ(scene.home.eye.y, 1.7);
}

TEST(BuiltinScene, KnotLoopKeepsAway) {
  const Scene scene = built("knot");
  double size = 0;
  for (const Vertex& v : scene.objects[0].mesh.vertices) {
    size = std::max(size, static_cast<double>(glm::length(v.position)));
  }
  const glm::dvec2 center(scene.home.eye.x + scene.home.walk_radius_m, scene.home.eye.z);
  EXPECT_GE(glm::length(center) - scene.home.walk_radius_m, 2.5 * size);
}

}  // namespace
}  // namespace mirage

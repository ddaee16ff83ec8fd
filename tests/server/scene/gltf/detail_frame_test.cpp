// Home views frame what carries the detail, whatever lies around or far from it.
#include "server/scene/gltf/detail_frame.h"

#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

using gltf::Bounds;
using gltf::DetailFrame;

/// A sphere of 2 * rows * rows triangles.
Mesh ball(int rows, float radius) {
  Mesh mesh;
  for (int y = 0; y <= rows; ++y) {
    for (int x = 0; x <= rows; ++x) {
      const float up = 3.14159265f * static_cast<float>(y) / static_cast<float>(rows);
      const float around = 6.28318531f * static_cast<float>(x) / static_cast<float>(rows);
      const glm::vec3 at(std::sin(up) * std::cos(around), std::cos(up),
                         std::sin(up) * std::sin(around));
      mesh.vertices.emplace_back().position = radius * at;
    }
  }
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < rows; ++x) {
      const auto a = static_cast<std::uint32_t>(y * (rows + 1) + x);
      const auto b = a + static_cast<std::uint32_t>(rows) + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
    }
  }
  return mesh;
}

Mesh quad(float half) {
  Mesh mesh;
  for (const glm::vec3& at : {glm::vec3(-half, 0, -half), glm::vec3(half, 0, -half),
                              glm::vec3(half, 0, half), glm::vec3(-half, 0, half)}) {
    mesh.vertices.emplace_back().position = at;
  }
  mesh.indices = {0, 2, 1, 0, 3, 2};
  return mesh;
}

struct Place {
  Scene scene;
  void add(const std::string& name, Mesh mesh, const glm::dvec3& at = {0, 0, 0}) {
    SceneObject& object = scene.objects.emplace_back();
    object.name = name;
    object.mesh = std::move(mesh);
    Instance& instance = scene.instances.emplace_back();
    instance.object = static_cast<std::uint32_t>(scene.objects.size() - 1);
    instance.world_from_object.position = at;
  }
  DetailFrame frame() const { return gltf::frame_detail(scene, gltf::scene_bounds(scene)); }
};

TEST(GltfDetailFrame, AModelAloneIsFramedWhole) {
  Place place;
  place.add("model", ball(20, 1));
  const DetailFrame frame = place.frame();
  EXPECT_FALSE(frame.leaves_out());
  EXPECT_EQ(frame.told(), "");
  EXPECT_NEAR(frame.bounds.radius(), std::sqrt(3.0), 1e-3);
}

TEST(GltfDetailFrame, SkiesAroundAModelAreLeftOut) {
  Place place;
  place.add("Stars", ball(48, 9000));
  place.add("model", ball(8, 1), {3, 0, 0});
  place.add("Clouds", ball(48, 5000));
  const DetailFrame frame = place.frame();
  EXPECT_EQ(frame.surrounding, (std::vector<std::string>{"Stars", "Clouds"}));
  EXPECT_NEAR(frame.bounds.radius(), std::sqrt(3.0), 0.1);
  EXPECT_NEAR(frame.bounds.center().x, 3, 0.1);
  EXPECT_EQ(frame.told(), "the home view leaves out 'Stars', 'Clouds', around everything else");
}

TEST(GltfDetailFrame, StrayTrianglesAreLeftOut) {
  Place place;
  place.add("model", ball(8, 1));
  place.add("stray", quad(0.01f), {20000, 0, 3000});
  EXPECT_NEAR(place.frame().bounds.radius(), std::sqrt(3.0), 0.1);
  EXPECT_NE(place.frame().told().find("of the triangles, far from the rest"), std::string::npos);

  // A stray triangle within the mesh itself.
  Place one;
  Mesh mesh = ball(30, 1);
  for (Vertex vertex : quad(0.01f).vertices) {
    vertex.position += glm::vec3(0, 400, 0);
    mesh.vertices.push_back(vertex);
  }
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.indices.insert(mesh.indices.end(), {last - 4, last - 3, last - 2});
  one.add("model", mesh);
  EXPECT_NEAR(one.frame().bounds.radius(), std::sqrt(3.0), 0.1);
}

TEST(GltfDetailFrame, AModelOnAVastFloorIsFramed) {
  Place place;
  place.add("floor", quad(2000));
  place.add("model", ball(30, 1), {40, 1, -700});
  const DetailFrame frame = place.frame();
  EXPECT_NEAR(frame.bounds.radius(), std::sqrt(3.0), 0.1);
  EXPECT_NEAR(frame.bounds.center().z, -700, 0.1);
}

TEST(GltfDetailFrame, PlacesAreFramedWhole) {
  // A room with a detailed pillow in a corner.
  Place room;
  room.add("room", ball(10, 5));
  room.add("pillow", ball(100, 0.3f), {3, -2, 0});
  EXPECT_FALSE(room.frame().leaves_out());
  // A forest on its ground.
  Place forest;
  forest.add("ground", quad(60));
  for (int i = 0; i < 100; ++i) {
    forest.add("tree", ball(8, 2), {10.0 * (i % 10) - 45, 2, 10.0 * (i / 10) - 45});
  }
  EXPECT_FALSE(forest.frame().leaves_out());
}

TEST(GltfDetailFrame, EmptyAndFlatScenesAreFramedWhole) {
  EXPECT_FALSE(Place().frame().leaves_out());
  Place point;
  point.add("point", quad(0));
  EXPECT_FALSE(point.frame().leaves_out());
}

}  // namespace
}  // namespace mirage::test

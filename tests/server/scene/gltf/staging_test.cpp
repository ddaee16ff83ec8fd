// Staging: the points that a home view shows, and the shadow on the floor.
#include "server/scene/gltf/staging.h"

#include <gtest/gtest.h>

namespace mirage::gltf {
namespace {

/// Returns an upright quad from (-1, `low`, 0) to (1, `low` + 2, 0).
Scene quad(float low) {
  Scene scene;
  SceneObject object;
  for (const glm::vec2 corner : {glm::vec2(-1, 0), {1, 0}, {1, 2}, {-1, 2}}) {
    Vertex v;
    v.position = {corner.x, corner.y, 0};
    object.mesh.vertices.push_back(v);
  }
  object.mesh.indices = {0, 1, 2, 0, 2, 3};
  object.mesh.primitives = {{PrimitiveKind::kTriangles, 0, 6, 0}};
  scene.objects = {object};
  Instance instance;
  instance.world_from_object.position = {100, low, -50};
  scene.instances = {instance};
  return scene;
}

float shadow_at(const StudioFloor& floor, double x, double z) {
  const auto cell = [&](double v) {
    return static_cast<std::size_t>((v / floor.half + 1) * 0.5 * StudioFloor::kEdge);
  };
  return static_cast<float>(floor.shadow.at(cell(z) * StudioFloor::kEdge + cell(x))) / 255;
}

TEST(GltfStaging, TheShadowIsWhereTheSceneTouchesTheFloor) {
  const Scene scene = quad(7);
  const Bounds frame = scene_bounds(scene);
  const StudioFloor floor = floor_under(scene, frame);
  EXPECT_EQ(floor.center, glm::dvec3(100, 7, -50));
  ASSERT_EQ(floor.shadow.size(), 4096u);
  EXPECT_GT(shadow_at(floor, 0, 0), 0.1f);
  EXPECT_GT(shadow_at(floor, 0.8, 0), 0.1f);
  EXPECT_LT(shadow_at(floor, 0, 0.9), 0.5f * shadow_at(floor, 0, 0));
  for (const double edge : {-1.99, 1.99}) {
    EXPECT_EQ(shadow_at(floor, edge, 0), 0) << "the shadow ends within its square";
    EXPECT_EQ(shadow_at(floor, 0, edge), 0);
  }
}

TEST(GltfStaging, WhatHangsHigherIsLighter) {
  Scene scene = quad(0);
  Bounds frame = scene_bounds(scene);
  const float touching = shadow_at(floor_under(scene, frame), 0, 0);
  frame.low.y -= 1;
  EXPECT_LT(shadow_at(floor_under(scene, frame), 0, 0), 0.5f * touching);
}

TEST(GltfStaging, OutermostPointsAreTheCornersOfAQuad) {
  const Scene scene = quad(7);
  std::vector<glm::vec3> points = outermost_points(scene, scene_bounds(scene));
  EXPECT_EQ(points.size(), 4u);
  for (const glm::vec3& p : points) EXPECT_EQ(glm::abs(p), glm::vec3(1, 1, 0));
  Bounds half = scene_bounds(scene);
  half.high.x = 99.5;
  for (const glm::vec3& p : outermost_points(scene, half)) EXPECT_LT(p.x + half.center().x, 99.6);
}

TEST(GltfStaging, ASceneWithoutExtentHasNoFloor) {
  EXPECT_EQ(floor_under({}, {}).half, 0);
  EXPECT_TRUE(outermost_points({}, {}).empty());
}

}  // namespace
}  // namespace mirage::gltf

// Covered surfaces: the later of two on the same corners is seen, wherever it can be proved.
#include "server/prepare/leave_out_covered.h"

#include <gtest/gtest.h>

#include "tests/gl/need_scenes.h"

namespace mirage::test {
namespace {

// Two balls at one place. The second has its own vertices for each triangle and another material.
Scene two_balls() {
  Scene scene = ball_scene();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].base_color = {0.1f, 0.2f, 0.9f, 1};
  const Mesh& first = scene.objects[0].mesh;
  Mesh second;
  for (std::size_t i = 0; i < first.indices.size(); i += 3) {
    for (const std::size_t k : {i + 1, i + 2, i}) {  // begins at another corner
      second.indices.push_back(static_cast<std::uint32_t>(second.vertices.size()));
      second.vertices.push_back(first.vertices[first.indices[k]]);
    }
  }
  second.primitives = {
      {PrimitiveKind::kTriangles, 0, static_cast<std::uint32_t>(second.indices.size()), 1}};
  scene.objects.push_back({"copy", second});
  scene.instances.resize(2);
  scene.instances[1].object = 1;
  return scene;
}

TEST(ServerLeaveOutCovered, OfTwoCopiesTheLaterIsSeen) {
  Scene scene = two_balls();
  const Covered found = leave_out_covered(scene);
  EXPECT_EQ(found.instances, 1u);
  ASSERT_EQ(scene.instances.size(), 1u);
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].name, "copy");
  EXPECT_EQ(scene.instances[0].object, 0u);
}

TEST(ServerLeaveOutCovered, WhatShowsThroughOrFromBehindStays) {
  const auto left = [](const std::function<void(Scene&)>& change) {
    Scene scene = two_balls();
    change(scene);
    leave_out_covered(scene);
    return scene.instances.size();
  };
  EXPECT_EQ(left([](Scene& s) { s.materials[1].alpha_mode = AlphaMode::kBlend; }), 2u);
  EXPECT_EQ(left([](Scene& s) { s.materials[1].alpha_mode = AlphaMode::kMask; }), 2u);
  EXPECT_EQ(left([](Scene& s) { s.materials[0].alpha_mode = AlphaMode::kMask; }), 1u);
  EXPECT_EQ(left([](Scene& s) { s.materials[1].double_sided = true; }), 1u);
  const auto turn = [](Scene& s) {
    std::vector<std::uint32_t>& indices = s.objects[1].mesh.indices;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) std::swap(indices[i], indices[i + 1]);
  };
  EXPECT_EQ(left(turn), 2u) << "each is seen from one side";
  EXPECT_EQ(left([&](Scene& s) {
              turn(s);
              s.materials[1].double_sided = true;
            }),
            1u);
  EXPECT_EQ(left([](Scene& s) { s.instances[1].world_from_object.scale = 1.001f; }), 2u);
  EXPECT_EQ(left([](Scene& s) { s.objects[0].animation = std::make_shared<Animation>(); }), 2u);
}

TEST(ServerLeaveOutCovered, RoundedTransformsAreTheSamePlaceFarAwayToo) {
  Scene scene = two_balls();
  const glm::quat turn = glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, 3)));
  for (Vertex& v : scene.objects[1].mesh.vertices) v.position = turn * v.position * 0.1f;
  scene.instances[0].world_from_object = {{4e5, 30, -7e5}, {1, 0, 0, 0}, 2};
  scene.instances[1].world_from_object = {{4e5, 30, -7e5}, glm::inverse(turn), 20};
  leave_out_covered(scene);
  EXPECT_EQ(scene.instances.size(), 1u);
}

TEST(ServerLeaveOutCovered, PartsAreLeftOutOfTheInstancesThatAreCovered) {
  Scene scene = two_balls();
  Mesh& copy = scene.objects[1].mesh;
  const std::size_t whole = scene.objects[0].mesh.indices.size() / 3;
  copy.indices.resize(3 * (whole / 2));
  copy.primitives[0].index_count = static_cast<std::uint32_t>(copy.indices.size());
  Scene twice = scene;
  const std::size_t found = leave_out_covered(scene).triangles;
  EXPECT_GT(found, whole / 2 - 30) << "all but those without area, at a pole";
  ASSERT_EQ(scene.objects.size(), 2u);
  const auto cut = [](const Scene& of) -> const SceneObject& {
    return of.objects[of.instances[0].object];
  };
  EXPECT_EQ(cut(scene).name, "ball");
  EXPECT_EQ(cut(scene).mesh.indices.size() / 3, whole - found);
  EXPECT_LT(cut(scene).mesh.vertices.size(), cut(twice).mesh.vertices.size());

  // Nothing covers a second instance: it keeps the whole mesh.
  twice.instances.push_back(twice.instances[0]);
  twice.instances[2].world_from_object.position.x = 50;
  leave_out_covered(twice);
  ASSERT_EQ(twice.objects.size(), 3u);
  EXPECT_EQ(cut(twice).mesh.indices.size() / 3, whole - found);
  EXPECT_EQ(twice.objects[twice.instances[2].object].mesh.indices.size() / 3, whole);
}

TEST(ServerLeaveOutCovered, ASideThatIsSeenStaysAndIsShadedAsBefore) {
  Scene scene = two_balls();
  scene.materials[0].double_sided = true;  // seen from within, through the later one's back
  scene.materials[0].normal_scale = 0.5f;
  const Covered found = leave_out_covered(scene);
  EXPECT_EQ(found.instances, 0u);
  ASSERT_EQ(found.materials, std::vector<std::uint32_t>{0});
  const Mesh& mesh = scene.objects[scene.instances[0].object].mesh;
  const Primitive& turned = mesh.primitives.back();
  ASSERT_EQ(turned.material, 2u);
  EXPECT_FALSE(scene.materials[2].double_sided);
  EXPECT_EQ(scene.materials[2].normal_scale, 0.5f);
  for (std::uint32_t i = 0; i < turned.index_count; i += 3) {
    const auto corner = [&](std::uint32_t k) {
      return mesh.vertices[mesh.indices[turned.first_index + i + k]];
    };
    const glm::vec3 up = glm::cross(corner(1).position - corner(0).position,
                                    corner(2).position - corner(0).position);
    ASSERT_GT(glm::dot(up, corner(0).normal), 0) << "front and normal on one side";
    ASSERT_LT(glm::dot(up, corner(0).position), 0) << "inwards";
  }
}

TEST(ServerLeaveOutCovered, WithinOneMeshTheLastTriangleIsSeen) {
  Scene scene = ball_scene();
  Mesh& mesh = scene.objects[0].mesh;
  const auto count = static_cast<std::uint32_t>(mesh.indices.size());
  scene.materials.push_back(scene.materials[0]);
  const std::vector<std::uint32_t> again = mesh.indices;
  mesh.indices.insert(mesh.indices.begin(), 2, 0u);  // a line before the triangles
  mesh.indices.insert(mesh.indices.end(), again.begin(), again.end());
  mesh.primitives = {{PrimitiveKind::kLines, 0, 2, 0},
                     {PrimitiveKind::kTriangles, 2, count, 0},
                     {PrimitiveKind::kTriangles, 2 + count, count, 1}};
  const std::size_t found = leave_out_covered(scene).triangles;
  EXPECT_GT(found, count / 3 - 30) << "all but those without area, at the poles";
  const Mesh& left = scene.objects[0].mesh;
  ASSERT_EQ(left.primitives.size(), 3u);
  EXPECT_EQ(left.primitives[0].kind, PrimitiveKind::kLines);
  EXPECT_EQ(left.primitives[2].index_count, count);
  EXPECT_EQ(left.indices.size(), 2 + 2 * count - 3 * found);
}

TEST(ServerLeaveOutCovered, ShapesOfOneMeshStayAFamily) {
  Scene scene = ball_scene();
  Mesh& mesh = scene.objects[0].mesh;
  const std::vector<std::uint32_t> again = mesh.indices;
  mesh.indices.insert(mesh.indices.end(), again.begin(), again.end());
  mesh.primitives[0].index_count *= 2;
  scene.objects[0].baked = BakedShape{3};
  scene.objects.push_back(scene.objects[0]);
  for (Vertex& v : scene.objects[1].mesh.vertices) v.position.x *= 2;
  scene.instances.resize(2);
  scene.instances[1].object = 1;
  scene.instances[1].world_from_object.position.x = 50;
  EXPECT_GT(leave_out_covered(scene).triangles, 0u);
  ASSERT_EQ(scene.objects.size(), 2u);
  ASSERT_TRUE(scene.objects[0].baked && scene.objects[1].baked);
  EXPECT_EQ(scene.objects[0].baked->base, scene.objects[1].baked->base);
  EXPECT_NE(scene.objects[0].baked->base, 3u) << "that is the whole mesh";
}

TEST(ServerLeaveOutCovered, NeighboursThatShareAnEdgeStay) {
  Scene scene = ball_scene();
  Mesh quad;
  for (const glm::vec3& p :
       {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0), glm::vec3(0, 1, 0)}) {
    quad.vertices.emplace_back().position = p;
  }
  quad.indices = {0, 1, 2, 0, 2, 3};
  quad.primitives = {{PrimitiveKind::kTriangles, 0, 6, 0}};
  scene.objects = {{"tile", quad}};
  scene.instances.assign(9, {});
  for (int i = 0; i < 9; ++i) scene.instances[i].world_from_object.position = {i % 3, i / 3, 0};
  const Covered found = leave_out_covered(scene);
  EXPECT_EQ(found.instances + found.triangles, 0u);
}

}  // namespace
}  // namespace mirage::test

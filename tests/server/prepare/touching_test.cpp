// Touching objects: which instances the tiles of an object keep clear of.
#include "server/prepare/touching.h"

#include <gtest/gtest.h>

#include "server/prepare/prepared_scene.h"

namespace mirage {
namespace {

using Ids = std::vector<std::uint32_t>;

constexpr std::uint32_t kBlock = 0, kPlate = 1;  // objects

// Returns a box around its origin.
SceneObject box(const glm::vec3& half) {
  SceneObject out;
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) {
      for (const float z : {-1.0f, 1.0f}) {
        Vertex v;
        v.position = half * glm::vec3(x, y, z);
        out.mesh.vertices.push_back(v);
      }
    }
  }
  Primitive faces;
  out.mesh.indices = {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                      2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};
  faces.index_count = static_cast<std::uint32_t>(out.mesh.indices.size());
  out.mesh.primitives = {faces};
  return out;
}

// Returns what touches the block and the plate, for instances of them at these places.
std::vector<Touching> touching(const std::vector<std::pair<std::uint32_t, glm::dvec3>>& placed) {
  Scene scene;
  scene.materials.resize(1);
  scene.objects = {box(glm::vec3(0.5f)), box({0.15f, 0.1f, 0.001f})};
  for (const auto& [object, position] : placed) {
    Instance one;
    one.object = object;
    one.world_from_object.position = position;
    scene.instances.push_back(one);
  }
  return (*prepare_scene(std::move(scene)))->touching;
}

TEST(ServerTouching, ABlockKeepsClearOfThePlateOnIt) {
  const std::vector<Touching> found = touching({{kBlock, {3, 0, 0}}, {kPlate, {3, 0, 0.502}}});
  EXPECT_EQ(found[kBlock].others, Ids{1});
  EXPECT_EQ(found[kBlock].instance, 0u);
  EXPECT_EQ(found[kPlate].others, Ids{}) << "its own depth is finer than that of the block";
}

TEST(ServerTouching, AllPlatesOnABlockCount) {
  EXPECT_EQ(touching({{kPlate, {0, 0, -0.502}},
                      {kBlock, {0, 0, 0}},
                      {kPlate, {0, 0, 0.502}},
                      {kPlate, {0, 0.3, 0.502}}})[kBlock]
                .others,
            (Ids{0, 2, 3}));
}

TEST(ServerTouching, WhatIsApartDoesNotCount) {
  EXPECT_EQ(touching({{kBlock, {0, 0, 0}}, {kPlate, {0, 0, 0.6}}})[kBlock].others, Ids{});
}

// Each use of the block has other neighbours, and one tile serves all of them.
TEST(ServerTouching, AnObjectUsedTwiceKeepsClearOfNothing) {
  EXPECT_EQ(
      touching({{kBlock, {0, 0, 0}}, {kPlate, {0, 0, 0.502}}, {kBlock, {9, 0, 0}}})[kBlock].others,
      Ids{});
}

}  // namespace
}  // namespace mirage

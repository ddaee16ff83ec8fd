// Touching objects: which instances the tiles of an object keep clear of.
#include "server/prepare/touching.h"

#include <gtest/gtest.h>

#include "server/prepare/prepared_scene.h"
#include "tests/support/boxes.h"

namespace mirage {
namespace {

using Ids = std::vector<std::uint32_t>;

constexpr std::uint32_t kBlock = 0, kPlate = 1;  // objects

Scene plates_and_blocks(const test::PlacedObjects& placed) {
  return test::placed_scene({test::box(glm::vec3(0.5f)), test::box({0.15f, 0.1f, 0.001f})}, placed);
}

// Returns what touches the block and the plate, for instances of them at these places.
std::vector<Touching> touching(const test::PlacedObjects& placed) {
  return (*prepare_scene(plates_and_blocks(placed)))->touching;
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

TEST(ServerTouching, AGroupIsHiddenByTheGroundUnderIt) {
  test::PlacedObjects placed;
  for (int i = 0; i < 64; ++i) placed.push_back({kPlate, {1.0 * (i % 8), 1.0 * (i / 8), 0}});
  Scene scene = plates_and_blocks(placed);
  scene.objects.push_back(test::box({20, 20, 0.01f}));  // of 12 triangles, as each plate
  Instance ground;
  ground.object = 2;
  scene.instances.push_back(ground);
  const std::shared_ptr<const PreparedScene> prepared = *prepare_scene(std::move(scene));
  ASSERT_FALSE(prepared->grouping.groups.empty());
  ASSERT_EQ(prepared->touching.size(), 3 + prepared->grouping.groups.size());
  for (std::size_t g = 0; g < prepared->grouping.groups.size(); ++g) {
    const Ids& others = prepared->touching[3 + g].others;
    // A part of the ground keeps clear of what its object does.
    ASSERT_EQ(others.empty(), prepared->grouping.groups[g].part != kNoGroup) << g;
    for (const std::uint32_t i : others) EXPECT_EQ(prepared->scene.instances[i].object, 2u) << g;
  }
}

}  // namespace
}  // namespace mirage

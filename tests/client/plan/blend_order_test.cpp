// Blend order: soft edges lie over what is behind them.
#include "client/plan/blend_order.h"

#include <gtest/gtest.h>

#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kDesk = 0;

constexpr std::uint32_t kCup = 1;

using Ids = std::vector<std::uint32_t>;

// A desk of radius 1 m at the origin, and a cup. The cup is on the desk whether it is before or
// behind the desk's centre. The eye is on the z axis.
TEST(CoreBlendOrder, WhatStandsOnAThingComesAfterIt) {
  const auto comes_after_desk = [](const glm::dvec3& cup) {
    const SceneView scene = make_scene({{{0, 0, 0}, 1}, {cup, 0.05f}});
    DrawnImpostor on, under;
    under.instance = kDesk;
    on.instance = kCup;
    const glm::dvec3 eye(0, 0, 5);
    return blend_distance(on, scene, eye) < blend_distance(under, scene, eye);
  };
  for (const double z : {0.9, 0.0, -0.9}) EXPECT_TRUE(comes_after_desk({0.3, 0.2, z})) << z;
  EXPECT_FALSE(comes_after_desk({0, 0, -2})) << "behind it";
}

// A glass ball of radius 1 m, and a small thing in it, behind it or before it.
TEST(CoreBlendOrder, WhatIsSeenThroughGlassComesBeforeIt) {
  const auto order = [](double z) {
    SceneView scene = make_scene({{{0, 0, 0}, 1, 0}, {{0, 0, z}, 0.05f, 1}}, {.objects = 2});
    scene.objects[0].needs |= kNeedBlend;
    std::vector<DrawnImpostor> drawn(3);
    drawn[1].instance = drawn[2].instance = kCup;
    drawn[kDesk].instance = kDesk;
    auto tile = std::make_shared<TileRecord>();
    tile->capture = Capture(ViewCell{4, 8, 8}, DistanceBucket{2, 9}, 1, 64);
    tile->measure.depth_min = static_cast<float>(tile->capture.distance - 1);
    drawn[kDesk].tile = tile;
    drawn[1].fade = 0.25f;
    sort_for_blending(drawn, scene, {0, 0, 5});
    Ids ids;
    for (const DrawnImpostor& one : drawn) ids.push_back(one.instance);
    return ids;
  };
  EXPECT_EQ(order(0), (Ids{kCup, kCup, kDesk})) << "within";
  EXPECT_EQ(order(-2), (Ids{kCup, kCup, kDesk})) << "behind";
  EXPECT_EQ(order(1.5), (Ids{kDesk, kCup, kCup})) << "before, and its tiles stay together";
}

}  // namespace
}  // namespace mirage::test

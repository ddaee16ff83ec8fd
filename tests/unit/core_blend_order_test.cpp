// Blend order: soft edges of flat impostors lie over the relief behind them, and under the one
// before them.
#include <gtest/gtest.h>

#include "client/core/blend_order.h"
#include "tests/unit/core_scene.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kDesk = 0;

constexpr std::uint32_t kCup = 1;

// Which of a desk, 1 m in radius, at the origin, and a flat cup come before relief and after; the
// eye is on the z axis.
struct Instances {
  std::vector<std::uint32_t> under, over;
};

Instances with_cup_at(const glm::dvec3& cup, DrawMethod desk_method = DrawMethod::kDepth) {
  const SceneView scene = make_scene({{{0, 0, 0}, 1}, {cup, 0.05f}});
  std::vector<DrawnImpostor> drawn(2);
  drawn[0].instance = kDesk;
  drawn[0].method = desk_method;
  drawn[1].instance = kCup;
  drawn[1].method = DrawMethod::kHull;
  const BlendOrder order = blend_order(drawn, scene, {0, 0, 5});
  Instances out;
  for (const DrawnImpostor* one : order.under_relief) out.under.push_back(one->instance);
  for (const DrawnImpostor* one : order.over_relief) out.over.push_back(one->instance);
  return out;
}

using Ids = std::vector<std::uint32_t>;

TEST(CoreBlendOrder, WhatStandsOnReliefComesAfterIt) {
  // Before and behind the desk's centre: it is on the desk either way.
  for (const double z : {0.9, 0.0, -0.9}) {
    const Instances order = with_cup_at({0.3, 0.2, z});
    EXPECT_EQ(order.over, Ids{kCup}) << z;
    EXPECT_EQ(order.under, Ids{}) << z;
  }
}

TEST(CoreBlendOrder, WhatIsBehindOrBesideReliefComesBeforeIt) {
  for (const glm::dvec3& cup : {glm::dvec3(0, 0, -2), glm::dvec3(3, 0, 0), glm::dvec3(0, 3, 1)}) {
    const Instances order = with_cup_at(cup);
    EXPECT_EQ(order.over, Ids{});
    EXPECT_EQ(order.under, Ids{kCup});
  }
}

// A desk that fills most of what is seen: cups before its rim, seen far from its middle.
TEST(CoreBlendOrder, NearReliefIsWide) {
  const SceneView scene = make_scene({{{0, 0, 0}, 1}, {{0, 1.0, 0.55}, 0.01f}});
  std::vector<DrawnImpostor> drawn(2);
  drawn[kDesk].instance = kDesk;
  drawn[kDesk].method = DrawMethod::kDepth;
  drawn[kCup].instance = kCup;
  EXPECT_EQ(blend_order(drawn, scene, {0, 0, 1.08}).over_relief.size(), 1u);
  EXPECT_EQ(blend_order(drawn, scene, {0, 0, 0.9}).over_relief.size(), 1u) << "from inside";
}

// A ball of glass, 1 m in radius, and something small in it, behind it or before it.
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

TEST(CoreBlendOrder, WithoutReliefAllKeepTheirOrder) {
  const Instances order = with_cup_at({0, 0, 0.5}, DrawMethod::kQuad);
  EXPECT_EQ(order.over, Ids{});
  EXPECT_EQ(order.under, (Ids{kDesk, kCup}));
}

}  // namespace
}  // namespace mirage::test

// Importance: the error that an instance may show, and which one is asked for first.
#include "client/plan/importance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

SelectorWorld ball_of(Importance importance) {
  SelectorWorld world(make_scene({{{0, 0, 0}, 1, 0, InstanceView::kNoParent, importance}}));
  world.look({0, 0, 5}, {0, 0, 0});
  return world;
}

// Three balls of one size and distance: left, ahead, right.
SelectorWorld three_balls() {
  SelectorWorld world(make_scene({{{-7, 0, -20}}, {{0, 0, -20}}, {{7, 0, -20}}}));
  world.look({0, 0, 0}, {0, 0, -1});
  return world;
}

double attention_at(const SelectorWorld& world, std::uint32_t instance) {
  return attention(world.camera, world.scene.instances[instance]);
}

TEST(CoreImportance, AttentionIsBoundedAndFallsFromTheMiddle) {
  SelectorWorld world = three_balls();
  EXPECT_EQ(attention_at(world, 1), 2);
  double before = 2;
  for (double yaw = 0.05; yaw < 3.1; yaw += 0.05) {
    world.look({0, 0, 0}, {std::sin(yaw), 0, -std::cos(yaw)});
    const double now = attention_at(world, 1);
    EXPECT_LE(now, before);
    EXPECT_GE(now, 1);
    before = now;
  }
  EXPECT_EQ(before, 1) << "behind the viewer";
  std::mt19937 random(3);
  std::uniform_real_distribution<double> at(-30, 30);
  for (int i = 0; i < 10'000; ++i) {
    world.look({at(random), at(random), at(random)}, {at(random), at(random), at(random)});
    const double a = attention_at(world, 1);
    ASSERT_GE(a, 1);
    ASSERT_LE(a, 2);
  }
}

TEST(CoreImportance, HalfAttentionAQuarterOfTheHeightBeside) {
  SelectorWorld world = three_balls();
  // The ball's edge lies there, not its centre: the centre is at height h, the middle at 0.
  const double beside = 0.25 * world.camera.height + world.camera.focal_px() / 20;
  world.look({0, 20 * beside / world.camera.focal_px(), 0},
             {0, 20 * beside / world.camera.focal_px(), -1});
  EXPECT_NEAR(attention_at(world, 1), 1.5, 1e-9);
}

TEST(CoreImportance, AnyImageBeatsNoneWhereverItIs) {
  SelectorWorld world = three_balls();
  const std::vector<TileNeed> needs = world.selector.needs(world.input());
  ASSERT_EQ(needs.size(), 3u);
  EXPECT_LT(needs[0].gain, 1.2 * needs[2].gain);
}

TEST(CoreImportance, SceneryIsGoodEnoughEarlierAndWhatIsImportantLater) {
  // The eye is off the tile's cell by an error of between a half and two tau.
  const auto needed = [](Importance importance, double aside) {
    SelectorWorld world = ball_of(importance);
    EXPECT_TRUE(world.add_tile(0));
    world.look({aside, 0, 5}, {0, 0, 0});
    SelectorInput in = world.input();
    in.march_budget_px = 0;
    const DrawList list = world.select(in);
    EXPECT_EQ(list.over_tau, world.selector.needs(in).size()) << "counted against what is allowed";
    return std::pair(world.selector.needs(in).size(), list.impostors.at(0).bound_px);
  };
  double largest[3] = {0, 0, 0};
  for (double aside = 0; aside < 0.4; aside += 0.001) {
    for (const Importance i : {Importance::kScenery, Importance::kNormal, Importance::kImportant}) {
      const auto [needs, bound_px] = needed(i, aside);
      if (needs == 0) {
        double& most = largest[static_cast<int>(i)];
        most = std::max(most, bound_px);
      }
    }
  }
  EXPECT_NEAR(largest[0], 2, 0.1);
  EXPECT_NEAR(largest[1], 1, 0.1);
  EXPECT_NEAR(largest[2], 0.5, 0.1);
}

TEST(CoreImportance, ASteeredTauRisesLastWhereTheViewerLooks) {
  EXPECT_EQ(allowed_error_px(1, 1, 2, Importance::kNormal), 1);
  EXPECT_EQ(allowed_error_px(1, 1, 1, Importance::kNormal), 1) << "not steered: no difference";
  EXPECT_EQ(allowed_error_px(1.8, 1, 2, Importance::kNormal), 1);
  EXPECT_EQ(allowed_error_px(1.8, 1, 1, Importance::kNormal), 1.8);
  EXPECT_EQ(allowed_error_px(8, 1, 2, Importance::kNormal), 4) << "bounded";
  EXPECT_EQ(allowed_error_px(8, 1, 2, Importance::kScenery), 8);
  EXPECT_EQ(allowed_error_px(8, 1, 2, Importance::kImportant), 2);
  SelectorWorld world = three_balls();
  SelectorInput in = world.input();
  in.tau_px = 4;
  in.target_px = 1;
  const std::vector<TileNeed> needs = world.selector.needs(in);
  ASSERT_EQ(needs.size(), 3u);
  ASSERT_EQ(needs[0].instance, 1u);
  EXPECT_GT(needs[0].cell.level, needs[1].cell.level) << "a finer cell for the middle";
}

}  // namespace
}  // namespace mirage::test

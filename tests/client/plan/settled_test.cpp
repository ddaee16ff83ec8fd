// Settled instances are not looked at in every frame, but again as soon as something may have
// changed.
#include <gtest/gtest.h>

#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

struct SettledWorld : SelectorWorld {
  SettledWorld() : SelectorWorld(make_scene({{{0, 0, 0}}})) {
    look({0, 0, 12}, {0, 0, 0});
    add_tile(0);
    stand(input());
  }
  // Asks twice, because everything is looked at again when a move ends.
  void stand(const SelectorInput& in) {
    for (int i = 0; i < 2; ++i) (void)selector.needs(in);
  }
  std::size_t needed(const SelectorInput& in) { return selector.needs(in).size(); }
  std::size_t needed() { return needed(input()); }
};

TEST(CoreSettled, NothingIsNeededOfAGoodTile) {
  SettledWorld world;
  EXPECT_EQ(world.needed(), 0u);
}

TEST(CoreSettled, AJumpIsSeenAtOnce) {
  SettledWorld world;
  world.look({12, 0, 0}, {0, 0, 0});
  EXPECT_EQ(world.needed(), 1u);
}

TEST(CoreSettled, AStricterTauIsSeenAtOnce) {
  SettledWorld world;
  world.look({0.3, 0, 12}, {0, 0, 0});
  world.now_us = 1'000'000;
  SelectorInput in = world.input();
  in.tau_px = 8;
  world.stand(in);
  ASSERT_EQ(world.needed(in), 0u);
  in.tau_px = 0.01;
  EXPECT_EQ(world.needed(in), 1u);
}

TEST(CoreSettled, AnotherZoomIsSeenAtOnce) {
  SettledWorld world;
  world.camera.fov_y *= 0.25;
  EXPECT_EQ(world.needed(), 1u);
}

TEST(CoreSettled, AWalkIsSeenATenthOfASecondLate) {
  // One selector has looked before, the other never has.
  SettledWorld watched, fresh;
  constexpr double kSpeed = 3;
  int first_watched = -1, first_fresh = -1;
  for (int ms = 0; ms < 4000; ms += 10) {
    for (SettledWorld* world : {&watched, &fresh}) {
      world->look({kSpeed * ms * 1e-3, 0, 12}, {0, 0, 0});
      world->now_us = ms * 1000;
      SelectorInput in = world->input();
      in.velocity = {kSpeed, 0, 0};
      in.method = {false, DrawMethod::kQuad, false};
      if (world == &fresh) world->selector.reset(world->scene);
      int& first = world == &watched ? first_watched : first_fresh;
      if (world->needed(in) > 0 && first < 0) first = ms;
    }
  }
  ASSERT_GT(first_fresh, 0);
  EXPECT_GE(first_watched, first_fresh);
  EXPECT_LE(first_watched, first_fresh + 100);
}

TEST(CoreSettled, NothingIsMissedWhenAMoveEnds) {
  // A tau so strict that less than a jump is too far for the tile.
  constexpr double kTau = 0.05;
  SelectorWorld world(make_scene({{{0, 0, 0}}}));
  world.look({0, 0, 12}, {0, 0, 0});
  const ObjectDescription& object = world.scene.objects[0];
  ViewPlan plan;
  plan.tau_px = kTau;
  const TileNeed need =
      need_for_view(view_geometry(world.camera, world.scene.instances[0], object), plan);
  const Capture capture = capture_for(need, object.radius);
  ASSERT_TRUE(world.cache.insert(0, world.scene, capture, make_tile(capture), world.frame, 0));
  const auto needed = [&](std::int64_t now_us) {
    world.now_us = now_us;
    SelectorInput in = world.input();
    in.tau_px = kTau;
    return world.selector.needs(in).size();
  };
  ASSERT_EQ(needed(0), 0u);
  world.look({0.05, 0, 12}, {0.05, 0, 0});
  ASSERT_EQ(needed(500), 0u) << "put off";
  EXPECT_EQ(needed(600), 1u);
}

}  // namespace
}  // namespace mirage::test

// What is settled is not looked at in every frame, and is again as soon as it may have changed.
#include <gtest/gtest.h>

#include "tests/unit/core_scene.h"

namespace mirage::test {
namespace {

struct SettledWorld : SelectorWorld {
  SettledWorld() : SelectorWorld(make_scene({{{0, 0, 0}}})) {
    look({0, 0, 12}, {0, 0, 0});
    add_tile(0);
    (void)selector.needs(input());
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
  // With a selector that has looked before, and with one that never has.
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

}  // namespace
}  // namespace mirage::test

// Moving objects on the client: the pose drawn, the phases asked for, stillness.
#include <gtest/gtest.h>

#include <set>

#include "client/ask/scheduler.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

/// One ball at the origin seen from ten radii, moving `speed` units a second in a clip of 2 s.
SelectorWorld moving_world(float speed) {
  SceneView scene = make_scene({{}});
  MotionProfile& motion = scene.objects[0].motion;
  motion.clip_s = 2;
  motion.speed.assign(limits::kMotionSegments, speed);
  SelectorWorld world(std::move(scene));
  world.look({0, 0, 10}, {0, 0, 0});
  return world;
}

void add_phase(SelectorWorld& world, const TileNeed& need) {
  const Capture capture = capture_for(need, 1);
  world.cache.insert(0, world.scene, capture, make_tile(capture), world.frame, world.now_us, 0,
                     need.phase);
}

/// Returns everything the client asks for until it wants no more.
std::vector<TileNeed> fetch_all(SelectorWorld& world, const SelectorInput& in) {
  std::vector<TileNeed> all;
  for (int round = 0; round < 20; ++round) {
    const std::vector<TileNeed> needs = world.selector.needs(in);
    if (needs.empty()) return all;
    for (const TileNeed& need : needs) add_phase(world, need);
    all.insert(all.end(), needs.begin(), needs.end());
  }
  ADD_FAILURE() << "never satisfied";
  return all;
}

TEST(CoreMotion, TheNearestPoseIsDrawnAndItsBoundGrowsWithTime) {
  SelectorWorld world = moving_world(0.1f);
  SelectorInput in = world.input();
  fetch_all(world, in);
  double last = 0;
  for (const double t : {0.0, 0.1, 0.2, 0.4}) {
    in.time_s = t;
    const DrawList list = world.select(in);
    ASSERT_EQ(list.impostors.size(), 1u);
    EXPECT_GE(list.impostors[0].bound_px, last);
    last = list.impostors[0].bound_px;
    EXPECT_EQ(list.time_s, t);
  }
  // 0.04 units at a distance of nine units.
  const double moved = world.camera.focal_px() * 0.04 / 9;
  EXPECT_GE(last, moved);
  EXPECT_LE(last, 1.2 * moved + 1);
}

TEST(CoreMotion, WithoutAnImageThereIsNoGhostOfAllItsPoses) {
  SelectorWorld moving = moving_world(0.1f), still = one_ball();
  EXPECT_EQ(moving.select(moving.input()).placeholders.size(), 0u);
  EXPECT_EQ(still.select(still.input()).placeholders.size(), 1u);
}

TEST(CoreMotion, PhasesAreAskedForAsFinelyAsTheObjectMoves) {
  std::size_t last = 0;
  for (const float speed : {0.001f, 0.03f, 0.3f}) {
    SelectorWorld world = moving_world(speed);
    SelectorInput in = world.input();
    in.horizon_s = 2;
    fetch_all(world, in);
    std::set<Phase> phases;
    for (double t = 0; t < 2; t += 0.01) {
      in.time_s = t;
      for (const TileNeed& need : world.selector.needs(in)) add_phase(world, need);
      const DrawList list = world.select(in);
      ASSERT_EQ(list.impostors.size(), 1u);
      EXPECT_LE(list.impostors[0].bound_px, in.tau_px) << speed << " at " << t;
      phases.insert(list.impostors[0].tile->phase);
    }
    EXPECT_GT(phases.size(), last) << speed;
    last = phases.size();
  }
  EXPECT_GT(last, 16u);
}

TEST(CoreMotion, ALoopOnceSeenCostsNothingMore) {
  SelectorWorld world = moving_world(0.1f);
  SelectorInput in = world.input();
  in.horizon_s = 0.2;
  in.lead_s = 0.1;
  std::size_t asked[3] = {};
  for (int loop = 0; loop < 3; ++loop) {
    for (double t = 0; t < 2; t += 1.0 / 60) {
      in.time_s = 2 * loop + t;
      for (const TileNeed& need : world.selector.needs(in)) {
        add_phase(world, need);
        ++asked[loop];
      }
    }
  }
  EXPECT_GT(asked[0], 5u);
  EXPECT_EQ(asked[2], 0u);
}

TEST(CoreMotion, AStandingAnimationIsAskedForOnceAndDrawnWithinTau) {
  SelectorWorld world = moving_world(0.3f);
  SelectorInput in = world.input();
  in.time_s = 0.777;  // and a horizon of 0: the clock stands still
  fetch_all(world, in);
  for (int frame = 0; frame < 100; ++frame) {
    EXPECT_TRUE(world.selector.needs(in).empty());
    const DrawList list = world.select(in);
    ASSERT_EQ(list.impostors.size(), 1u);
    EXPECT_LE(list.impostors[0].bound_px, in.tau_px);
  }
}

TEST(CoreMotion, StaticObjectsHaveNoPhase) {
  SelectorWorld world(make_scene({{}}));
  world.look({0, 0, 10}, {0, 0, 0});
  SelectorInput in = world.input();
  in.time_s = 12.3;
  in.horizon_s = 0.2;
  const std::vector<TileNeed> needs = world.selector.needs(in);
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].phase, kStaticPhase);
}

TEST(CoreMotion, AsksLookAheadByTheRoundTrip) {
  SelectorWorld world = moving_world(0.3f);
  SelectorInput in = world.input();
  fetch_all(world, in);  // so that the first, coarse phase is there
  in.time_s = 0.5;
  in.lead_s = 0.25;
  in.horizon_s = 0.3;
  const std::vector<TileNeed> needs = world.selector.needs(in);
  ASSERT_FALSE(needs.empty());
  for (const TileNeed& need : needs) {
    EXPECT_GE(phase_time(need.phase, 2), 0.74);
    EXPECT_LE(phase_time(need.phase, 2), 0.82);
  }
}

TEST(CoreMotion, SeveralPhasesOfAnInstanceAreUnderWayAtOnce) {
  SelectorWorld world = moving_world(0.1f);
  Scheduler scheduler;
  std::vector<TileNeed> needs(3);
  for (std::size_t i = 0; i < 3; ++i) needs[i].phase = static_cast<Phase>(1 + i);
  const auto first = scheduler.plan(world.scene, needs, {}, 0, 0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->asks.size(), 3u);
  EXPECT_EQ(first->asks[2].phase(), 3);
  EXPECT_FALSE(scheduler.plan(world.scene, needs, {}, 0, 1000)) << "none is asked for twice";
  // A phase that has passed comes again, so nothing is cancelled while the object is wanted.
  needs.resize(1);
  EXPECT_FALSE(scheduler.plan(world.scene, needs, {}, 0, 2000));
}

TEST(CoreMotion, CopiesAreOffsetInTheClip) {
  SelectorWorld world = moving_world(0.3f);
  world.scene.instances[0].clip_offset_s = 0.5;
  const ViewGeometry view =
      view_geometry(world.camera, world.scene.instances[0], world.scene.objects[0], 1.75);
  EXPECT_NEAR(view.clip_time_s, 0.25, 1e-12);
}

}  // namespace
}  // namespace mirage::test

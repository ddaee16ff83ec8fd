// Stillness: a picture is kept exactly as long as nothing that drawing reads has changed.
#include "client/session/stillness.h"

#include <gtest/gtest.h>

#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

struct CoreStillness : ::testing::Test {
  CoreStillness() : world(make_scene({{glm::dvec3(0, 0, -20), 1}, {glm::dvec3(5, 0, -20), 1}})) {
    world.look({0, 0, 0}, {0, 0, -1});
    world.add_tile(0);
  }
  /// Asks `us` microseconds later.
  bool unchanged(std::int64_t us = 16'000) {
    ++world.frame;
    world.now_us += us;
    const SelectorInput in = world.input();
    DrawList list = world.select(in);
    list.time_s = static_cast<double>(world.now_us) * 1e-6;
    return stillness.unchanged({world.camera, &world.scene, list, light});
  }
  void settle() {
    for (int i = 0; i < 100; ++i) unchanged();
    ASSERT_TRUE(unchanged());
  }
  SelectorWorld world;
  Stillness stillness;
  Lighting light;
};

TEST_F(CoreStillness, TheFirstFrameIsDrawnAndTheNextIsKept) {
  EXPECT_FALSE(unchanged());
  EXPECT_TRUE(unchanged());
  EXPECT_TRUE(unchanged(10'000'000)) << "time alone changes nothing";
}

TEST_F(CoreStillness, CameraLightAndContentWakeIt) {
  settle();
  world.look({0, 1e-6, 0}, {0, 0, -1});
  EXPECT_FALSE(unchanged());
  EXPECT_TRUE(unchanged());
  world.camera.width += 1;
  EXPECT_FALSE(unchanged());
  EXPECT_TRUE(unchanged());
  light.ambient.r += 0.01f;
  EXPECT_FALSE(unchanged());
  EXPECT_TRUE(unchanged());
  light.lights.emplace_back();
  EXPECT_FALSE(unchanged());
  EXPECT_TRUE(unchanged());
  stillness.content_changed();
  EXPECT_FALSE(unchanged());
  EXPECT_TRUE(unchanged());
}

TEST_F(CoreStillness, ATileThatTakesOverIsDrawnUntilItsFadeIsOver) {
  settle();
  world.look({0.5, 0, 0}, {0, 0, -20});
  world.add_tile(0);
  EXPECT_FALSE(unchanged());
  int drawn = 0;
  while (!unchanged() && drawn < 100) ++drawn;
  EXPECT_GE(drawn, 3) << "the fade takes 120 ms";
  EXPECT_LT(drawn, 20);
  EXPECT_TRUE(unchanged());
}

TEST_F(CoreStillness, GeometryThatMovesIsDrawnWithTheClock) {
  settle();
  const auto frame = [&](double time_s) {
    DrawList list;
    list.meshes = {{1, 0, 1}};
    list.time_s = time_s;
    return stillness.unchanged({world.camera, &world.scene, list, light});
  };
  EXPECT_FALSE(frame(1));
  EXPECT_TRUE(frame(2));
  MotionProfile& motion = world.scene.objects[0].motion;
  motion.clip_s = 1;
  EXPECT_FALSE(frame(3));
  EXPECT_FALSE(frame(4));
  EXPECT_TRUE(frame(4));
}

}  // namespace
}  // namespace mirage::test

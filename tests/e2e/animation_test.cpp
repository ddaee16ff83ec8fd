// Moving objects end to end: impostors move as in the full render, within their bounds, and objects
// at rest cost nothing.

#include <gtest/gtest.h>

#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

nlohmann::json watch(const std::string& asset, int frames, const std::string& more) {
  const Server server(asset);
  EXPECT_TRUE(server.ready()) << server.log();
  return view(server,
              "--offscreen 320x180 --path builtin:still --net rtt=60,rate=50,server-ms=3,seed=1 "
              "--frames " +
                  std::to_string(frames) + " " + more)
      .stats;
}

class Animation : public ::testing::Test {
 protected:
  static std::string asset(const std::string& name) { return shared_folder() + "/assets/" + name; }
};

// The floors are some 4 dB below the measured values.
TEST_F(Animation, ImpostorsMoveWithinTheirBounds) {
  struct Case {
    const char* name;
    double least_psnr;
  };
  for (const Case& c :
       {Case{"features/fox_skinned.glb", 28.0}, Case{"objects/desk_fan_skinned.glb", 30.0},
        Case{"features/milk_truck_animated.glb", 26.0},
        Case{"features/morph_stress_test.glb", 26.0}}) {
    const nlohmann::json s = watch(asset(c.name), 121, "--reference 60 --mesh-radii 0");
    ASSERT_FALSE(s.is_discarded()) << c.name;
    const nlohmann::json& q = s["quality"];
    EXPECT_GT(q["compared_pixels"], 1000) << c.name;
    EXPECT_EQ(q["bound_violations"], 0) << c.name << ": " << q.dump();
    EXPECT_GT(q["psnr"]["min"], c.least_psnr) << c.name << ": " << q.dump();
    EXPECT_GT(q["iou"]["min"], 0.9) << c.name << ": " << q.dump();
    EXPECT_GT(s["impostors_drawn"], 0.5) << c.name;
  }
}

TEST_F(Animation, GeometryIsPosedAsTheServerDoes) {
  const nlohmann::json s =
      watch(asset("features/fox_skinned.glb"), 61, "--reference 15 --method mesh");
  ASSERT_FALSE(s.is_discarded());
  EXPECT_GT(s["meshes_drawn"], 0.5);
  EXPECT_GT(s["quality"]["psnr"]["min"], 29.0);
  EXPECT_GT(s["quality"]["iou"]["min"], 0.97);
}

TEST_F(Animation, AStandingClipAndALoopOnceSeenCostNothing) {
  const std::string fox = asset("features/fox_skinned.glb");
  const nlohmann::json one = watch(fox, 60, "--animation off --mesh-radii 0");
  const nlohmann::json four = watch(fox, 240, "--animation off --mesh-radii 0");
  ASSERT_FALSE(one.is_discarded() || four.is_discarded());
  EXPECT_EQ(one["tiles"]["asked"], four["tiles"]["asked"]);
  EXPECT_LE(four["tiles"]["asked"], 4);
  EXPECT_EQ(one["bytes_down"], four["bytes_down"]);
  // The truck's clip is 1.25 s. There are three loops: tiles are asked for in the first, and late
  // ones arrive after it.
  const std::string truck = asset("features/milk_truck_animated.glb");
  const nlohmann::json two_loops = watch(truck, 180, "--mesh-radii 0");
  const nlohmann::json more = watch(truck, 300, "--mesh-radii 0");
  EXPECT_EQ(two_loops["tiles"]["asked"], more["tiles"]["asked"]);
}

}  // namespace
}  // namespace mirage::test

// Stillness: if nothing moves and everything is settled, nothing is rendered, sent or drawn. Light,
// animation and camera wake the client (numerics.md section 5, rule 20). --explain tells scenes
// apart.

#include <gtest/gtest.h>

#include <set>

#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

nlohmann::json watch(const Server& server, const std::string& more, int frames) {
  return view(server, "--offscreen 160x90 --net rtt=50,rate=20,server-ms=5,seed=1 --frames " +
                          std::to_string(frames) + " " + more)
      .stats;
}

int drawn(const nlohmann::json& stats) { return stats["frames_drawn"]; }

constexpr const char* kScene = "builtin:forest?trees=30&clutter=10";

TEST(Stillness, NothingIsAskedSentOrDrawnOnceAllIsSettled) {
  const Server server(kScene);
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string still = "--path builtin:still";
  const nlohmann::json settled = watch(server, still, 300), later = watch(server, still, 900);
  EXPECT_GT(settled["tiles"]["received"], 10);
  EXPECT_LT(drawn(settled), 100);
  EXPECT_EQ(drawn(later), drawn(settled)) << "600 frames more draw nothing";
  EXPECT_EQ(later["tiles"], settled["tiles"]);
  EXPECT_EQ(later["bytes_up"], settled["bytes_up"]);
  EXPECT_EQ(later["bytes_down"], settled["bytes_down"]);
}

// Trees so large that a shadow tile of the largest size is still coarse for them.
TEST(Stillness, LargeThingsInShadowComeToRest) {
  const Server server("builtin:forest?trees=80&clutter=10", {"--shadows", "on", "--no-geometry"});
  ASSERT_TRUE(server.ready()) << server.log();
  const nlohmann::json seen =
      view(server,
           "--offscreen 1280x720 --frames 240 --fps 20 --net rtt=40,rate=40,server-ms=3,seed=1 "
           "--device-model software --frame-ms 50 --path #eye=-20,1.7,0&look=-20,1.7,-1")
          .stats;
  EXPECT_GT(seen["tiles"]["received"], 200);
  EXPECT_LT(seen["tiles"]["last_asked_ms"], 10'000) << "nothing is asked for after 10 s";
  EXPECT_LT(drawn(seen), 200);
}

TEST(Stillness, CameraAndLightWakeIt) {
  const Server server(kScene);
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(drawn(watch(server, "--path builtin:walk", 120)), 120);
  const std::string lamp = "--path builtin:still --light builtin:lamp-toggle";
  const nlohmann::json once = watch(server, lamp, 400), again = watch(server, lamp, 700);
  EXPECT_GT(drawn(again), drawn(once)) << "the lamp goes on and off";
  EXPECT_LT(drawn(again), 500) << "and stands still between";
}

TEST(Stillness, AnimationIsDrawn) {
  const std::string fox = shared_folder() + "/assets/features/fox_skinned.glb";
  const Server server(fox);
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string still = "--path builtin:still";
  EXPECT_GT(drawn(watch(server, still, 120)), 60);
  EXPECT_LT(drawn(watch(server, still + " --animation off", 120)), 60);
}

TEST(Explain, NamesDifferentThingsOfDifferentScenes) {
  std::set<std::set<std::string>> told;
  const std::string shared = shared_folder();
  std::vector<std::string> scenes = {"builtin:forest?trees=10&clutter=5",
                                     "builtin:knot?tubular=16&radial=8"};
  scenes.push_back(shared + "/assets/objects/flight_helmet.glb");
  scenes.push_back(shared + "/assets/features/unlit_test/unlit_test.gltf");
  for (const std::string& scene : scenes) {
    const Finished done = run({binary("mirage-server"), scene, "--explain", "--json"}, 60);
    ASSERT_EQ(done.exit_code, 0) << done.output;
    const nlohmann::json all = nlohmann::json::parse(done.output);
    EXPECT_EQ(all["rules"].size(), 29u);
    std::set<std::string> things;
    for (const nlohmann::json& object : all["objects"]) {
      for (const nlohmann::json& one : object["left_out"]) {
        things.insert(one["left_out"].get<std::string>() + ": " + one["why"].get<std::string>());
      }
    }
    EXPECT_GT(things.size(), 4u);
    EXPECT_TRUE(told.insert(things).second) << scene << " is told like another";
  }
}

TEST(Explain, ProvesAKnot) {
  const Finished done = run({binary("mirage-server"), "builtin:knot?tubular=16&radial=8",
                             "--explain", "--prove", "--prove-cells", "1", "--json"},
                            120);
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const nlohmann::json all = nlohmann::json::parse(done.output.substr(done.output.find("\n{") + 1));
  EXPECT_EQ(all["total"]["differing_components"], 0);
  EXPECT_GT(all["total"]["bytes_ratio"], 1.5);
  EXPECT_GE(all["rows"].size(), 8u);
  for (const nlohmann::json& row : all["rows"]) {
    for (const char* key :
         {"scene", "object", "rule", "left_out", "differing_components", "saved"}) {
      EXPECT_TRUE(row.contains(key)) << key;
    }
  }
}

}  // namespace
}  // namespace mirage::test

// The sun's shadows from end to end: the viewer's picture against the full render that has them.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

constexpr const char* kScene = "builtin:forest?trees=60&clutter=20";

std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

struct Seen {
  int exit_code = -1;
  std::string output, stats, last_frame;
  nlohmann::json json;
};

Seen walk(const Server& server, const std::string& shadows) {
  const std::string folder = scratch_folder();
  const Finished view = run({binary("mirage-view"),
                             server.url(),
                             "--offscreen",
                             "240x136",
                             "--path",
                             "builtin:walk",
                             "--fps",
                             "4",
                             "--frames",
                             "21",
                             "--virtual-time",
                             "--net",
                             "rtt=60,rate=40,server-ms=2,seed=1",
                             "--reference",
                             "10",
                             "--mesh-radii",
                             "3",
                             "--shadows",
                             shadows,
                             "--stats",
                             folder + "/s.json",
                             "--out",
                             folder},
                            300);
  Seen seen{
      view.exit_code, view.output, read(folder + "/s.json"), read(folder + "/frame_00020.png"), {}};
  if (view.exit_code == 0) seen.json = nlohmann::json::parse(seen.stats);
  return seen;
}

TEST(ShadowsEndToEnd, TheViewerHasWhatTheFullRenderHas) {
  const Server server(kScene, {"--shadows", "on"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Seen with = walk(server, "on"), without = walk(server, "off");
  ASSERT_EQ(with.exit_code, 0) << with.output;
  ASSERT_EQ(without.exit_code, 0) << without.output;
  const double flip = with.json["quality"]["flip"]["mean"];
  const double bare = without.json["quality"]["flip"]["mean"];
  std::printf("FLIP %.3f, without shadows %.3f\n", flip, bare);
  EXPECT_LT(flip, 0.5 * bare);
  EXPECT_LT(flip, 0.12);
  EXPECT_EQ(with.json["quality"]["bound_violations"], 0);
  EXPECT_EQ(with.json["tiles"]["refused"], 0);
  // A server that has none: the same viewer draws what it draws without.
  const Server plain(kScene);
  ASSERT_TRUE(plain.ready()) << plain.log();
  const Seen left_out = walk(plain, "on");
  ASSERT_EQ(left_out.exit_code, 0) << left_out.output;
  EXPECT_EQ(left_out.last_frame, without.last_frame);
}

TEST(ShadowsEndToEnd, TwoRunsAreTheSameToTheByte) {
  Seen runs[2];
  for (Seen& seen : runs) {
    const Server server(kScene, {"--shadows", "on"});
    ASSERT_TRUE(server.ready()) << server.log();
    seen = walk(server, "on");
    ASSERT_EQ(seen.exit_code, 0) << seen.output;
  }
  EXPECT_EQ(runs[0].stats, runs[1].stats);
  EXPECT_EQ(runs[0].last_frame, runs[1].last_frame);
}

TEST(ShadowsEndToEnd, ExplainSaysWhyThereAreNone) {
  const auto explain = [](const std::string& scene, const std::string& shadows) {
    return run({binary("mirage-server"), scene, "--explain", "--shadows", shadows}, 60).output;
  };
  EXPECT_NE(explain("builtin:knot", "off").find("shadow tiles: --shadows is off"),
            std::string::npos);
  EXPECT_EQ(explain("builtin:knot", "on").find("shadow tiles"), std::string::npos);
  EXPECT_NE(explain("builtin:clutter?objects=5", "on").find("the scene's light has no sun"),
            std::string::npos);
}

}  // namespace
}  // namespace mirage::test

// The sun's shadows end to end: the viewer's picture against the full render with shadows.

#include <gtest/gtest.h>

#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

constexpr const char* kScene = "builtin:forest?trees=60&clutter=20";

struct Seen {
  Viewed viewed;
  std::string last_frame;
};

Seen walk(const Server& server, const std::string& shadows) {
  const std::string folder = scratch_folder();
  const Viewed viewed = view(server,
                             "--offscreen 240x136 --path builtin:walk --fps 4 --frames 21 "
                             "--net rtt=60,rate=40,server-ms=2,seed=1 --reference 10 "
                             "--mesh-radii 3 --shadows " +
                                 shadows + " --out " + folder,
                             folder);
  return {viewed, read_file(folder + "/frame_00020.png")};
}

TEST(ShadowsEndToEnd, TheViewerHasWhatTheFullRenderHas) {
  const Server server(kScene, {"--shadows", "on"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Seen with = walk(server, "on"), without = walk(server, "off");
  ASSERT_TRUE(with.viewed.stats.is_object() && without.viewed.stats.is_object());
  const double flip = with.viewed.stats["quality"]["flip"]["mean"];
  const double bare = without.viewed.stats["quality"]["flip"]["mean"];
  std::printf("FLIP %.3f, without shadows %.3f\n", flip, bare);
  EXPECT_LT(flip, 0.5 * bare);
  EXPECT_LT(flip, 0.12);
  EXPECT_EQ(with.viewed.stats["quality"]["bound_violations"], 0);
  EXPECT_EQ(with.viewed.stats["tiles"]["refused"], 0);
  // A server without shadows: the same viewer draws the same as without them.
  const Server plain(kScene);
  ASSERT_TRUE(plain.ready()) << plain.log();
  const Seen left_out = walk(plain, "on");
  EXPECT_EQ(left_out.last_frame, without.last_frame);
}

TEST(ShadowsEndToEnd, TwoRunsAreTheSameToTheByte) {
  Seen runs[2];
  for (Seen& seen : runs) {
    const Server server(kScene, {"--shadows", "on"});
    ASSERT_TRUE(server.ready()) << server.log();
    seen = walk(server, "on");
    ASSERT_FALSE(seen.viewed.text.empty() || seen.last_frame.empty());
  }
  EXPECT_EQ(runs[0].viewed.text, runs[1].viewed.text);
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

// Counters of a short walk: a change that draws, asks, renders, sends, uploads or compiles more
// fails here, on any machine. Counts that follow from scene and path may move by the share beside
// them when the selection is changed on purpose. All others are exact.
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/metrics.h"
#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

constexpr const char* kScene = "builtin:forest?trees=60&clutter=20";
const std::string kWalk =
    "--offscreen 320x180 --path builtin:walk --frames 61 --net rtt=100,rate=20,server-ms=5,seed=1";

void expect_about(double value, double expected, double share, const char* what) {
  EXPECT_NEAR(value, expected, share * expected) << what;
}

TEST(Counters, OfAShortWalk) {
  const Server server(kScene, {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const nlohmann::json s = view(server, kWalk).stats;
  ASSERT_TRUE(s.is_object());
  std::map<std::string, double> m = metrics(server);

  expect_about(s["draw_calls"], 19.1, 0.05, "draw calls a frame");
  EXPECT_LE(s["draw_calls_max"], 30);

  // Every ask that was not cancelled is one rendering, and one reply.
  expect_about(s["tiles"]["asked"], 29, 0.08, "tiles asked for");
  EXPECT_EQ(m["tiles_rendered_total"], m["tiles_asked_total"]);
  EXPECT_EQ(s["tiles"]["received"], m["tiles_rendered_total"]);
  EXPECT_EQ(m["tiles_rendered_total"], m["store_tiles"]) << "each once";
  EXPECT_EQ(m["store_evictions_total"], 0);
  EXPECT_EQ(s["tiles"]["refused"], 0);
  expect_about(s["bytes_down"], 899'240, 0.05, "bytes down");

  const nlohmann::json& uploads = s["uploads"];
  EXPECT_LE(uploads["tiles"], s["tiles"]["received"]);
  expect_about(uploads["tiles"], 29, 0.08, "tiles uploaded");
  expect_about(uploads["bytes"], 6'931'402, 0.05, "bytes uploaded");
  expect_about(uploads["largest_frame_bytes"], 1'668'360, 0.1, "bytes uploaded in one frame");
  EXPECT_EQ(uploads["frames_over_budget"], 0);

  // All of the server's shaders exist before the first ask. All of the client's that do not depend
  // on materials exist before the scene. Those of materials come with the geometry that has them,
  // and none is compiled within a draw. Two of the server's draw the depth of the ground in the
  // tiles of groups.
  EXPECT_EQ(m["shader_programs"], 21);
  EXPECT_EQ(m["shader_programs_after_ready_total"], 0);
  EXPECT_EQ(s["programs"]["compiled"], 16);
  EXPECT_EQ(s["programs"]["after_scene"], 6);
  EXPECT_EQ(s["programs"]["in_draws"], 0);
}

// One tile of the whole scene arrives before the first image of an object, unless server or client
// turn it off.
TEST(Counters, APictureComesBeforeTheImages) {
  const Server server(kScene, {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const nlohmann::json s = view(server, kWalk).stats;
  ASSERT_TRUE(s.is_object());
  EXPECT_GE(s["view_tiles"]["drawn"], 1);
  EXPECT_LT(s["first_picture_ms"], 340) << "three round trips and the view";
  EXPECT_GT(s["time_to_first_image_ms"], s["first_picture_ms"].get<double>() + 90);
  const nlohmann::json without = view(server, kWalk + " --no-view").stats;
  EXPECT_EQ(without["view_tiles"]["asked"], 0);
  EXPECT_EQ(without["first_picture_ms"], without["time_to_first_image_ms"]);
  std::map<std::string, double> m = metrics(server);
  EXPECT_EQ(m["views_sent_total"], s["view_tiles"]["asked"]);
  const Server plain(kScene, {"--no-view"});
  ASSERT_TRUE(plain.ready()) << plain.log();
  const nlohmann::json refused = view(plain, kWalk).stats;
  EXPECT_EQ(refused["view_tiles"]["asked"], 1) << "and never again";
  EXPECT_EQ(refused["view_tiles"]["drawn"], 0);
  EXPECT_EQ(refused["first_picture_ms"], refused["time_to_first_image_ms"]);
}

TEST(Counters, NoTileIsRenderedTwiceForManyClients) {
  const Server server(kScene, {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Finished load = run({binary("mirage-load"), server.url(), "--clients", "8", "--duration",
                             "4", "--rate", "10", "--spread", "0", "--path", "builtin:walk"},
                            60);
  ASSERT_EQ(load.exit_code, 0) << load.output;
  std::map<std::string, double> m = metrics(server);
  // Tiles under way when the clients left are still being encoded.
  for (int i = 0; i < 20 && m["tiles_rendered_total"] != m["store_tiles"]; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    m = metrics(server);
  }
  EXPECT_GT(m["tiles_rendered_total"], 20);
  EXPECT_GT(m["tiles_merged_total"] + m["store_hits_total"], 20);
  EXPECT_EQ(m["tiles_rendered_total"], m["store_tiles"]) << "each once";
  EXPECT_EQ(m["store_evictions_total"], 0);
  EXPECT_EQ(m["shader_programs_after_ready_total"], 0);
}

// Repeats the walk with uploads spread over frames. As much is uploaded in all, and no frame takes
// more than its budget. The largest upload here is a level of a mesh or an image, alone in its
// frame.
TEST(Counters, UploadsKeepToTheirBudget) {
  const Server server(kScene);
  ASSERT_TRUE(server.ready()) << server.log();
  const nlohmann::json free = view(server, kWalk).stats;
  const nlohmann::json held = view(server, kWalk + " --upload-kb 256").stats;
  ASSERT_TRUE(free.is_object() && held.is_object());
  EXPECT_GT(held["uploads"]["frames_over_budget"], 0);
  EXPECT_LE(held["uploads"]["largest_frame_bytes"], free["uploads"]["largest_frame_bytes"]);
  expect_about(held["uploads"]["bytes"], free["uploads"]["bytes"], 0.1, "bytes uploaded");
}

}  // namespace
}  // namespace mirage::test

// Wrong use, broken scenes, vanished servers, hostile clients.

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/process.h"
#include "tests/support/raw_peer.h"

namespace mirage::test {
namespace {

void expect_error(const Finished& done, int code, const std::string& id) {
  EXPECT_EQ(done.exit_code, code) << done.output;
  EXPECT_NE(done.output.find("error " + id + ":"), std::string::npos) << done.output;
}

TEST(Failure, WrongUseEndsWithTwo) {
  expect_error(run({binary("mirage-server")}), 2, "usage");
  expect_error(run({binary("mirage-server"), "builtin:knot", "--nonsense"}), 2, "usage");
  expect_error(run({binary("mirage-server"), "builtin:knot", "--listen", "nowhere"}), 2, "usage");
  expect_error(run({binary("mirage-view")}), 2, "usage");
  expect_error(run({binary("mirage-view"), "ftp://x"}), 2, "usage");
  expect_error(run({binary("mirage-view"), "ws://x:1", "--offscreen", "0x5"}), 2, "usage");
  expect_error(run({binary("mirage-view"), "ws://x:1", "--fov", "180"}), 2, "usage");
  expect_error(run({binary("mirage-view"), "ws://x:1", "--fov", "nan"}), 2, "usage");
  expect_error(run({binary("mirage-view"), "ws://x:1", "--net", "rtt=banana"}), 2, "usage");
}

// A server names the limit that it hits, and ends; it neither aborts nor hangs.
TEST(Failure, TooLittleMemoryEndsWithFour) {
  for (const int kilobytes : {300'000, 400'000}) {
    const std::string command = "ulimit -v " + std::to_string(kilobytes) + "; exec " +
                                binary("mirage-server") + " builtin:knot --listen 127.0.0.1:0";
    const Finished done = run({"/bin/sh", "-c", command}, 30);
    EXPECT_EQ(done.exit_code, 4) << kilobytes << ": " << done.output;
    EXPECT_NE(done.output.find("ulimit -v is " + std::to_string(kilobytes)), std::string::npos)
        << done.output;
  }
}

TEST(Failure, UnusableScenesEndWithThreeQuickly) {
  expect_error(run({binary("mirage-server"), "/nonexistent.glb"}, 5), 3, "scene-missing");
  expect_error(run({binary("mirage-server"), "builtin:nosuch"}, 5), 3, "scene-builtin");
  const std::string text = scratch_folder() + "/text.glb";
  std::ofstream(text) << "this is no scene";
  expect_error(run({binary("mirage-server"), text}, 5), 3, "scene-format");
}

TEST(Failure, UnusableSurroundingsEndQuickly) {
  // A server that does not end at once would serve for ever. The limit leaves time to read the
  // libraries of images from a cold disk on a busy machine, which has taken more than 5 s.
  const auto in = [](const std::string& environment) {
    return run({binary("mirage-server"), "builtin:knot", "--environment", environment}, 30);
  };
  expect_error(in("/nonexistent.hdr"), 3, "scene-missing");
  expect_error(in("builtin:nosuch"), 2, "usage");
  const std::string text = scratch_folder() + "/text.exr", large = scratch_folder() + "/16k.hdr";
  std::ofstream(text) << "these are no surroundings";
  expect_error(in(text), 3, "scene-format");
  std::ofstream(large) << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 16384\n";
  expect_error(in(large), 3, "scene-limit");
}

TEST(Failure, NobodyThereEndsWithFive) {
  expect_error(run({binary("mirage-view"), "ws://127.0.0.1:1", "--offscreen", "64x64",
                    "--connect-timeout", "0.5"}),
               5, "network-connect");
}

TEST(Failure, TakenPortEndsWithFive) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  expect_error(run({binary("mirage-server"), "builtin:knot", "--listen",
                    "127.0.0.1:" + std::to_string(server.port())}),
               5, "network-listen");
}

TEST(Failure, TokenIsAsked) {
  const std::string folder = scratch_folder();
  std::ofstream(folder + "/token") << "secret\n";
  const Server server("builtin:knot", {"--token-file", folder + "/token"});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::vector<std::string> view = {
      binary("mirage-view"), server.url(), "--offscreen", "64x64", "--frames", "5", "--path",
      "builtin:still"};
  expect_error(run(view), 5, "auth");
  std::vector<std::string> with = view;
  with.insert(with.end(), {"--token-file", folder + "/token"});
  EXPECT_EQ(run(with).exit_code, 0);
}

TEST(Failure, ViewerKeepsItsFrameRateWhenTheServerVanishes) {
  Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string stats = scratch_folder() + "/s.json";
  Finished view;
  std::thread viewer([&] {
    view = run({binary("mirage-view"), server.url(), "--mesh-radii", "0", "--offscreen", "160x120",
                "--path", "builtin:still", "--frames", "120", "--fps", "30", "--stats", stats});
  });
  std::this_thread::sleep_for(std::chrono::seconds(2));
  server.stop(SIGKILL);
  viewer.join();
  ASSERT_EQ(view.exit_code, 0) << view.output;
  EXPECT_NE(view.output.find("server is gone"), std::string::npos) << view.output;
  std::ifstream file(stats);
  const nlohmann::json s = nlohmann::json::parse(file);
  EXPECT_EQ(s["frames"], 120);
  EXPECT_LT(s["frame_ms"]["p95"], 50.0);  // a blocked frame would take seconds
  EXPECT_GT(s["impostors_drawn"], 0.5);   // stale tiles stay on the screen
}

TEST(Failure, ViewerComesBackWithTheServer) {
  auto server = std::make_unique<Server>("builtin:knot");
  ASSERT_TRUE(server->ready()) << server->log();
  const std::string listen = "127.0.0.1:" + std::to_string(server->port());
  Finished view;
  std::thread viewer([&] {
    view = run({binary("mirage-view"), server->url(), "--offscreen", "160x120", "--path",
                "builtin:orbit", "--frames", "240", "--fps", "30"});
  });
  std::this_thread::sleep_for(std::chrono::seconds(2));
  server->stop(SIGKILL);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  const Server again("builtin:knot", {"--listen", listen});  // the last --listen counts
  EXPECT_TRUE(again.ready()) << again.log();
  viewer.join();
  EXPECT_EQ(view.exit_code, 0) << view.output;
  EXPECT_NE(view.output.find("server is back"), std::string::npos) << view.output;
}

TEST(Failure, HostilePeersHurtNobodyElse) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string key = kUpgradeKey;
  {
    RawPeer junk(server.port());
    ASSERT_TRUE(junk.connected());
    junk.say(std::string(5000, '\xff'));
    RawPeer old(server.port());
    old.say(upgrade("8", key));
    EXPECT_EQ(old.hear().find("101"), std::string::npos);
    RawPeer short_key(server.port());
    short_key.say(upgrade("13", "abc"));
    EXPECT_EQ(short_key.hear().find("101"), std::string::npos);
    RawPeer text(server.port());
    text.say(upgrade("13", key));
    EXPECT_NE(text.hear().find("101"), std::string::npos);
    text.say(frame(1, "hello"));
    text.hear();
    RawPeer garbage(server.port());
    garbage.say(upgrade("13", key));
    EXPECT_NE(garbage.hear().find("101"), std::string::npos);
    garbage.say(frame(2, std::string(100, 'x')));
    const std::string close = garbage.hear();
    ASSERT_GE(close.size(), 4u);
    EXPECT_EQ(close[0] & 0x0f, 8);  // opcode of a close packet
    EXPECT_EQ((static_cast<unsigned char>(close[2]) << 8) | static_cast<unsigned char>(close[3]),
              1002);  // code for a protocol error
    RawPeer stalled(server.port());
    stalled.say("GET / HT");
    const Finished view = run({binary("mirage-view"), server.url(), "--offscreen", "64x64",
                               "--frames", "20", "--path", "builtin:still"});
    EXPECT_EQ(view.exit_code, 0) << view.output;
  }
  EXPECT_NE(server.log().find("wire-malformed"), std::string::npos) << server.log();
}

}  // namespace
}  // namespace mirage::test

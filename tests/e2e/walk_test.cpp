// The main use: server, viewer, modelled network, comparison with the full render.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

constexpr const char* kScene = "builtin:forest?trees=60&clutter=20";

/// Walks and leaves its pictures in the folder.
Viewed walk(const Server& server, const std::string& folder, int frames) {
  return view(server,
              "--offscreen 320x180 --path builtin:walk --net rtt=100,rate=20,server-ms=5,seed=1 "
              "--reference 30 --frames " +
                  std::to_string(frames) + " --out " + folder,
              folder);
}

TEST(Walk, StatsHaveTheContractAndNoBoundIsExceeded) {
  const Server server(kScene);
  ASSERT_TRUE(server.ready()) << server.log();
  const nlohmann::json s = walk(server, scratch_folder(), 91).stats;
  ASSERT_TRUE(s.is_object());
  for (const char* key : {"/frames",
                          "/frame_ms/p50",
                          "/frame_ms/p95",
                          "/frame_ms/p99",
                          "/frame_ms/max",
                          "/time_to_first_image_ms",
                          "/bytes_down",
                          "/bytes_up",
                          "/mbps_mean",
                          "/tiles/asked",
                          "/tiles/received",
                          "/tiles/drawn",
                          "/tiles/wasted",
                          "/tiles/cancelled",
                          "/tiles/refused",
                          "/stale_fraction",
                          "/tile_age_ms/p50",
                          "/tile_age_ms/p95",
                          "/tile_age_ms/p99",
                          "/bound_px/p50",
                          "/bound_px/p95",
                          "/bound_px/p99",
                          "/bound_px/max",
                          "/over_tau_fraction",
                          "/hole_fraction",
                          "/draw_calls",
                          "/instances_drawn",
                          "/impostors_drawn",
                          "/meshes_drawn",
                          "/gpu_bytes",
                          "/quality/flip/mean",
                          "/quality/flip/p95",
                          "/quality/flip/worst",
                          "/quality/psnr/mean",
                          "/quality/psnr/min",
                          "/quality/ssim/mean",
                          "/quality/ssim/min",
                          "/quality/iou/mean",
                          "/quality/iou/min",
                          "/quality/bound_violations",
                          "/prediction/error_m/p50",
                          "/prediction/error_m/p95",
                          "/prediction/error_deg/p50",
                          "/prediction/error_deg/p95"}) {
    EXPECT_TRUE(s.contains(nlohmann::json::json_pointer(key))) << key;
  }
  EXPECT_EQ(s["frames"], 91);
  EXPECT_EQ(s["quality"]["bound_violations"], 0);
  EXPECT_GT(s["quality"]["compared_pixels"], 1000);
  EXPECT_GT(s["impostors_drawn"], 5);
  EXPECT_LT(s["quality"]["flip"]["mean"], 0.25);
}

TEST(Walk, TwoRunsAreTheSameToTheByte) {
  const std::string first = scratch_folder(), second = scratch_folder();
  std::string stats[2], stats_later;
  for (const int i : {0, 1}) {
    const Server server(kScene);  // a new server: nothing may depend on what it holds
    ASSERT_TRUE(server.ready()) << server.log();
    stats[i] = walk(server, i == 0 ? first : second, 61).text;
    if (i == 1) stats_later = walk(server, scratch_folder(), 61).text;
  }
  EXPECT_FALSE(stats[0].empty());
  EXPECT_EQ(stats[0], stats[1]);
  EXPECT_EQ(stats[0], stats_later) << "who was there before left tiles and views behind";
  int frames = 0;
  for (const auto& entry : std::filesystem::directory_iterator(first)) {
    if (entry.path().extension() != ".png") continue;
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(read_file(first + "/" + name), read_file(second + "/" + name)) << name;
    ++frames;
  }
  EXPECT_GE(frames, 61);
}

TEST(Walk, MethodsAllDraw) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  for (const char* method : {"mesh", "quad", "cuboid", "hull", "warp", "depth", "auto"}) {
    const nlohmann::json s = view(server, std::string("--offscreen 160x120 --path builtin:orbit "
                                                      "--frames 41 --net rtt=20,server-ms=2 "
                                                      "--reference 40 --method ") +
                                              method)
                                 .stats;
    ASSERT_TRUE(s.is_object()) << method;
    EXPECT_EQ(s["quality"]["bound_violations"], 0) << method;
    EXPECT_GT(s["quality"]["iou"]["mean"], 0.9) << method;
    EXPECT_LT(s["hole_fraction"], 0.01) << method;
  }
}

TEST(Walk, LightMoves) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const nlohmann::json s =
      view(server,
           "--offscreen 160x120 --path builtin:still --light builtin:sun-sweep --frames 90 "
           "--net rtt=20,server-ms=2 --relight never --mesh-radii 0")
          .stats;
  ASSERT_TRUE(s.is_object());
  EXPECT_GE(s["tiles"]["received"], 5);  // 1.5 s with a sun that moves every frame
}

// Returns the samples a pixel at the end, after some seconds of frames that are all too slow.
nlohmann::json after_slow_frames(const Server& server, const std::vector<std::string>& more) {
  const std::string folder = scratch_folder();
  std::vector<std::string> command = {
      binary("mirage-view"), server.url(), "--offscreen", "320x240",         "--path",
      "builtin:orbit",       "--fps",      "1000",        "--frames",        "1000",
      "--frame-ms",          "0.001",      "--stats",     folder + "/s.json"};
  command.insert(command.end(), more.begin(), more.end());
  const Finished done = run(command, 120);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  return nlohmann::json::parse(read_file(folder + "/s.real_time.json"), nullptr, false);
}

TEST(Walk, SamplesFollowWhatFramesTake) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(after_slow_frames(server, {"--msaa", "4"})["samples_at_end"], 4);
  EXPECT_EQ(after_slow_frames(server, {"--virtual-time"})["samples_at_end"], 4);
  const nlohmann::json chosen = after_slow_frames(server, {});
  const std::string renderer = chosen["client_renderer"];
  if (renderer.find("llvmpipe") == std::string::npos) GTEST_SKIP() << "too quick to be slow";
  EXPECT_EQ(chosen["samples_at_end"], 0);
}

// timeout(1) sends the signal twice, to the program and to its group.
TEST(Walk, CtrlCEndsItWithItsFiguresWritten) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder();
  const Finished done =
      run({"/usr/bin/timeout", "--preserve-status", "-s", "INT", "12", binary("mirage-view"),
           server.url(), "--offscreen", "64x64", "--path", "builtin:orbit", "--frames", "1000000",
           "--stats", folder + "/s.json", "--trace", folder + "/t.json"},
          60);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  const auto json = [&](const char* name) {
    return nlohmann::json::parse(read_file(folder + name), nullptr, false);
  };
  EXPECT_GT(json("/s.json").value("frames", 0), 1);
  const nlohmann::json frames = json("/t.json").value("frames", nlohmann::json::array());
  ASSERT_GT(frames.size(), 1u);
  double stages = 0;
  for (const auto& [key, value] : frames[1].items()) {
    const bool stage = key.size() > 3 && key.compare(key.size() - 3, 3, "_ms") == 0;
    if (stage && key != "budget_ms") stages += value.get<double>();
  }
  EXPECT_NEAR(stages, frames[1]["ms"].get<double>(), 0.01);
  EXPECT_EQ(json("/s.real_time.json")["drawn"]["frames"], frames.size());
}

TEST(Walk, ASessionEndsAfterItsSeconds) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const nlohmann::json s =
      view(server, "--offscreen 64x64 --path builtin:orbit --virtual-time --fps 10 --seconds 2",
           scratch_folder())
          .stats;
  EXPECT_EQ(s["frames"], 20);
}

TEST(Walk, ServerDrainsOnTerm) {
  Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(server.stop(SIGTERM), 0);
}

}  // namespace
}  // namespace mirage::test

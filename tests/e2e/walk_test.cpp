// The main job: server, viewer, modelled network, comparison with the full render.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::string> walk(const Server& server, const std::string& folder, int frames) {
  return {binary("mirage-view"),
          server.url(),
          "--offscreen",
          "320x180",
          "--path",
          "builtin:walk",
          "--frames",
          std::to_string(frames),
          "--virtual-time",
          "--net",
          "rtt=100,rate=20,server-ms=5,seed=1",
          "--reference",
          "30",
          "--stats",
          folder + "/s.json",
          "--out",
          folder};
}

constexpr const char* kScene = "builtin:forest?trees=60&clutter=20";

TEST(Walk, StatsHaveTheContractAndNoBoundIsExceeded) {
  const Server server(kScene);
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder();
  const Finished view = run(walk(server, folder, 91), 240);
  ASSERT_EQ(view.exit_code, 0) << view.output;
  const nlohmann::json s = nlohmann::json::parse(read(folder + "/s.json"));
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
  for (const std::string& folder : {first, second}) {
    const Server server(kScene);  // a fresh server: nothing may depend on what it holds
    ASSERT_TRUE(server.ready()) << server.log();
    const Finished view = run(walk(server, folder, 61), 240);
    ASSERT_EQ(view.exit_code, 0) << view.output;
  }
  EXPECT_EQ(read(first + "/s.json"), read(second + "/s.json"));
  int frames = 0;
  for (const auto& entry : std::filesystem::directory_iterator(first)) {
    if (entry.path().extension() != ".png") continue;
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(read(first + "/" + name), read(second + "/" + name)) << name;
    ++frames;
  }
  EXPECT_GE(frames, 61);
}

TEST(Walk, MethodsAllDraw) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  for (const char* method : {"mesh", "quad", "cuboid", "hull", "warp", "depth", "auto"}) {
    const std::string folder = scratch_folder();
    const Finished view =
        run({binary("mirage-view"), server.url(), "--offscreen", "160x120", "--path",
             "builtin:orbit", "--frames", "41", "--virtual-time", "--net", "rtt=20,server-ms=2",
             "--method", method, "--reference", "40", "--stats", folder + "/s.json"});
    ASSERT_EQ(view.exit_code, 0) << method << ": " << view.output;
    const nlohmann::json s = nlohmann::json::parse(read(folder + "/s.json"));
    EXPECT_EQ(s["quality"]["bound_violations"], 0) << method;
    EXPECT_GT(s["quality"]["iou"]["mean"], 0.9) << method;
    EXPECT_LT(s["hole_fraction"], 0.01) << method;
  }
}

TEST(Walk, LightMoves) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder();
  const Finished view = run({binary("mirage-view"), server.url(), "--offscreen", "160x120",
                             "--path", "builtin:still", "--light", "builtin:sun-sweep", "--frames",
                             "90", "--virtual-time", "--net", "rtt=20,server-ms=2", "--stats",
                             folder + "/s.json", "--relight", "never", "--mesh-radii", "0"});
  ASSERT_EQ(view.exit_code, 0) << view.output;
  const nlohmann::json s = nlohmann::json::parse(read(folder + "/s.json"));
  EXPECT_GE(s["tiles"]["received"], 5);  // 1.5 s of a sun that moves every frame
}

TEST(Walk, ServerDrainsOnTerm) {
  Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(server.stop(SIGTERM), 0);
}

}  // namespace
}  // namespace mirage::test

// scripts/demo as a newcomer runs it, without building and a display.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

using nlohmann::json;

Finished demo(const std::string& scene, const std::string& out) {
  const std::string bin = std::filesystem::path(binary("mirage-view")).parent_path().string();
  return run({"/usr/bin/env", "-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", "MIRAGE_DEMO_FRAMES=10",
              "MIRAGE_DEMO_BIN=" + bin, "MIRAGE_DEMO_OUT=" + out,
              std::string(MIRAGE_SOURCE_DIR) + "/scripts/demo", scene},
             300);
}

/// A row of its table: Mirage, all geometry, and the key of both in their files.
struct Row {
  double mirage = -1, geometry = -1;
  std::string key;
};
Row row(const std::string& output, const std::string& name) {
  Row out;
  const std::size_t at = output.find("\n" + name);
  if (at == std::string::npos) return out;
  std::istringstream(output.substr(at + 1 + name.size())) >> out.mirage >> out.geometry >> out.key;
  return out;
}

TEST(Demo, PrintsBothWaysAndLeavesSheetAndAnimation) {
  const std::string out = scratch_folder() + "/demo";
  const Finished ran = demo("builtin:clutter?objects=60", out);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const std::string commands = read_file(out + "/commands.txt");
  // Name, file of Mirage's figure, its place, scale, and half of the last digit that is printed.
  const std::tuple<const char*, const char*, const char*, double, double> rows[] = {
      {"first picture, ms", "real", "/first_picture_ms", 1, 0.51},
      {"frame, ms, median", "real.real_time", "/drawn/ms_after_5s/p50", 1, 0.51},
      {"frame by the price model, ms, median", "stats", "/frame_ms/p50", 1, 0.51},
      {"FLIP against the full render, mean", "stats", "/quality/flip/mean", 1, 0.00051},
      {"from the server, MB", "stats", "/bytes_down", 1e-6, 0.051}};
  for (const auto& [name, file, pointer, scale, rounding] : rows) {
    const Row found = row(ran.output, name);
    const json figures = json::parse(read_file(out + "/" + file + ".json"));
    const double figure = figures[json::json_pointer(pointer)].get<double>() * scale;
    EXPECT_NEAR(found.mirage, figure, rounding) << name << "\n" << ran.output;
    EXPECT_GT(found.mirage, 0) << name << "\n" << ran.output;
    EXPECT_GT(found.geometry, 0) << name << "\n" << ran.output;
    std::string key = std::string(pointer).substr(1);
    std::replace(key.begin(), key.end(), '/', '.');
    EXPECT_EQ(found.key, key);
  }
  for (const char* file : {"real", "real_geometry", "stats", "geometry"}) {
    EXPECT_NE(commands.find("--stats " + out + "/" + file + ".json\n"), std::string::npos)
        << commands;
  }
  EXPECT_EQ(read_file(out + "/contact_sheet.png").substr(1, 3), "PNG");
  const std::string walk = read_file(out + "/walk.webp");
  EXPECT_EQ(walk.substr(8, 4), "WEBP");
  EXPECT_NE(walk.substr(0, 64).find("ANIM"), std::string::npos);
  EXPECT_LT(walk.size(), 3'000'000u);
}

TEST(Demo, PassesTheServersErrorOn) {
  const Finished ran = demo("builtin:no-such-scene", scratch_folder() + "/demo");
  EXPECT_EQ(ran.exit_code, 3) << ran.output;
  EXPECT_NE(ran.output.find("error scene-builtin"), std::string::npos) << ran.output;
}

}  // namespace
}  // namespace mirage::test

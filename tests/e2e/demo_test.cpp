// scripts/demo as a newcomer runs it, without building and a display.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

Finished demo(const std::string& scene, const std::string& out) {
  const std::string bin = std::filesystem::path(binary("mirage-view")).parent_path().string();
  return run({"/usr/bin/env", "-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", "MIRAGE_DEMO_FRAMES=10",
              "MIRAGE_DEMO_BIN=" + bin, "MIRAGE_DEMO_OUT=" + out,
              std::string(MIRAGE_SOURCE_DIR) + "/scripts/demo", scene},
             300);
}

/// Returns the two figures of a row of its table: Mirage, all geometry.
std::pair<double, double> row(const std::string& output, const std::string& name) {
  const std::size_t at = output.find("\n" + name);
  if (at == std::string::npos) return {-1, -1};
  char* end = nullptr;
  const double mirage = std::strtod(output.c_str() + at + 1 + name.size(), &end);
  return {mirage, std::strtod(end, nullptr)};
}

TEST(Demo, PrintsBothWaysAndLeavesSheetAndAnimation) {
  const std::string out = scratch_folder() + "/demo";
  const Finished ran = demo("builtin:clutter?objects=60", out);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  for (const char* name : {"first picture, ms", "frame by the price model, ms, median",
                           "frame as this machine drew it, ms, median",
                           "error against the full render, FLIP, mean", "from the server, MB"}) {
    const auto [mirage, geometry] = row(ran.output, name);
    EXPECT_GT(mirage, 0) << name << "\n" << ran.output;
    EXPECT_GT(geometry, 0) << name << "\n" << ran.output;
  }
  EXPECT_NE(ran.output.find(" frames a second"), std::string::npos) << ran.output;
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

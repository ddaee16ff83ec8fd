// Budgets of a frame: they hold, larger ones buy less error, and a frame can say why it is drawn as
// it is. Device models are read, or refused by name.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

constexpr const char* kWalk =
    "--offscreen 320x180 --path builtin:walk --fps 20 --frames 81 --net "
    "rtt=100,rate=20,server-ms=5 "
    "--reference 20 --reference-samples 2 ";

TEST(Budget, HoldsAndBuysLessErrorTheLargerItIs) {
  const Server server("builtin:forest?trees=60");
  ASSERT_TRUE(server.ready()) << server.log();
  double before = 1;
  for (const int ms : {16, 30, 120}) {
    const std::string folder = scratch_folder();
    const std::string limit = "--device-model software --frame-ms " + std::to_string(ms);
    const nlohmann::json stats =
        view(server, kWalk + limit + " --explain-frame " + folder + "/why.json", folder).stats;
    EXPECT_EQ(stats["budget_ms"], ms);
    EXPECT_LE(stats["frame_ms"]["p95"], 1.1 * ms);
    EXPECT_EQ(stats["quality"]["bound_violations"], 0);
    EXPECT_LT(stats["quality"]["flip"]["mean"], before) << ms;
    before = stats["quality"]["flip"]["mean"];
    const nlohmann::json why = nlohmann::json::parse(read_file(folder + "/why.json"));
    EXPECT_EQ(why["budget_ms"], ms);
    EXPECT_LE(why["expected_ms"], ms);
    EXPECT_EQ(why["frame"], 81);
    ASSERT_GT(why["things"].size(), 20u);
    double things_ms = 0;
    std::size_t choices = 0;
    for (const nlohmann::json& thing : why["things"]) {
      things_ms += thing["chosen"]["ms"].get<double>();
      choices += thing["alternatives"].size() > 1;
      EXPECT_GE(thing["alternatives"].size(), 1u);
    }
    EXPECT_GT(choices, 5u);
    EXPECT_NEAR(things_ms, why["things_ms"], 1e-6);
    EXPECT_LE(things_ms, why["expected_ms"]);
  }
}

TEST(Budget, OneThatNothingFitsInIsHarmless) {
  const Server server("builtin:forest?trees=10&clutter=5");
  ASSERT_TRUE(server.ready()) << server.log();
  for (const char* ms : {"0.01", "10000"}) {
    const nlohmann::json stats =
        view(server, std::string(kWalk) + "--device-model phone --frame-ms " + ms).stats;
    EXPECT_GT(stats["tiles"]["received"].get<int>() + stats["meshes_drawn"].get<double>(), 0);
    EXPECT_EQ(stats["scale"].get<double>() < 0.6, std::stod(ms) < 1) << ms;
  }
}

TEST(Budget, DeviceModelsAreReadOrRefusedByName) {
  const Server server("builtin:knot?tubular=16&radial=8");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder();
  const auto told = [&](const std::string& text) {
    std::ofstream(folder + "/model.json") << text;
    return run({binary("mirage-view"), server.url(), "--virtual-time", "--offscreen", "64x36",
                "--frames", "2", "--frame-ms", "50", "--device-model", folder + "/model.json"});
  };
  const auto refused = [&](const std::string& text, const std::string& why) {
    const Finished done = told(text);
    EXPECT_EQ(done.exit_code, 2) << text;
    EXPECT_NE(done.output.find(why), std::string::npos) << done.output;
  };
  refused("", "no JSON object");
  refused("{\"ms\": {\"frame\": 1}}", "no price of 'pixel'");
  refused("{\"ms\": {\"frame\": -1}}", "the price of 'frame' is no time");
  refused("{\"ms\": {\"frame\": null}}", "the price of 'frame' is no time");
  refused("{\"ms\": {\"frame\": NaN}}", "no JSON object");
  const Finished none = run({binary("mirage-view"), server.url(), "--virtual-time", "--offscreen",
                             "64x36", "--device-model", "toaster"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.output.find("software, laptop, phone"), std::string::npos) << none.output;
}

}  // namespace
}  // namespace mirage::test

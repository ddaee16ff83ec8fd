// Weather table: which weathers there are, and what is computed from their runs.
#include <gtest/gtest.h>

#include <set>

#include "client/report/weather_rows.h"

namespace mirage::test {
namespace {

WeatherRun run(const Weather& weather, std::uint64_t seed, double flip, double psnr_db) {
  WeatherRun run;
  run.weather = weather;
  run.seed = seed;
  run.flip = {{1, flip}, {2, 2 * flip}};
  run.flip_mean = 1.5 * flip;
  run.flip_worst = 2 * flip;
  run.psnr_db = psnr_db;
  run.bound_violations = seed;
  return run;
}

std::string cell(const Table& table, std::size_t row, const std::string& column) {
  return table.rows()[row][table.column(column)];
}

TEST(Weather, TenOfThemEachWithItsOwnName) {
  std::set<std::string> names;
  for (const Weather& w : weathers_on("")) {
    names.insert(w.name);
    EXPECT_GT(w.net.rate_mbps, 0) << w.name;
    EXPECT_GE(w.net.server_ms, 0) << w.name << ": or figures hang on the machine";
  }
  EXPECT_EQ(names.size(), 10u);
}

TEST(Weather, OnASceneAreThoseOfItsKindOnThatVeryScene) {
  const std::vector<Weather> rooms = weathers_on("builtin:clutter?objects=150");
  ASSERT_EQ(rooms.size(), 2u);
  for (const Weather& w : rooms) EXPECT_EQ(w.scene, "builtin:clutter?objects=150");
  EXPECT_TRUE(weathers_on("room.glb").empty());
  EXPECT_TRUE(weathers_on("ws://127.0.0.1:9870").empty());
}

TEST(Weather, SeedsMakeOtherScenesUnlessTheyHaveOptions) {
  EXPECT_EQ(seeded("builtin:forest", 3), "builtin:forest?seed=3");
  EXPECT_EQ(seeded("builtin:field?instances=9", 3), "builtin:field?instances=9");
}

TEST(Weather, TableHasMediansOverSeedsAndOverWeathers) {
  const std::vector<Weather> all = weathers_on("");
  const Table table =
      weather_table({run(all[0], 1, 0.02, 40), run(all[1], 1, 0.10, 30), run(all[0], 2, 0.06, 38),
                     run(all[1], 2, 0.10, 30), run(all[0], 3, 0.04, NAN)});
  ASSERT_EQ(table.rows().size(), 4u);
  EXPECT_EQ(cell(table, 0, "weather"), all[0].name);
  EXPECT_EQ(cell(table, 0, "FLIP"), "0.06");
  EXPECT_EQ(cell(table, 0, "FLIP, worst seed"), "0.09");
  EXPECT_EQ(cell(table, 0, "FLIP, worst frame"), "0.12");
  EXPECT_EQ(cell(table, 0, "PSNR, dB"), "39");  // of the two runs that have one
  EXPECT_EQ(cell(table, 0, "over bound, px"), "6");
  EXPECT_EQ(cell(table, 2, "weather"), "median");
  EXPECT_EQ(cell(table, 2, "FLIP"), "0.105");
  EXPECT_EQ(cell(table, 3, "weather"), "worst");
  EXPECT_EQ(cell(table, 3, "FLIP"), "0.15");
  EXPECT_EQ(cell(table, 3, "PSNR, dB"), "30");
}

TEST(Weather, CsvHasARowForEachRun) {
  const std::vector<Weather> all = weathers_on("");
  const Table csv = weather_csv({run(all[0], 1, 0.02, 40), run(all[8], 2, 0.02, NAN)});
  EXPECT_EQ(csv.columns(), (std::vector<std::string>{"weather",
                                                     "scene",
                                                     "path",
                                                     "seed",
                                                     "rtt_ms",
                                                     "jitter_ms",
                                                     "rate_mbps",
                                                     "loss_pct",
                                                     "server_ms",
                                                     "flip_mean",
                                                     "flip_worst",
                                                     "psnr_db",
                                                     "hole_fraction",
                                                     "no_image_fraction",
                                                     "starved_fraction",
                                                     "mb",
                                                     "link_used",
                                                     "bound_violations",
                                                     "budget_ms",
                                                     "client_ms_p95"}));
  EXPECT_EQ(cell(csv, 0, "scene"), "builtin:forest?seed=1");
  EXPECT_EQ(cell(csv, 1, "scene"), "builtin:field?instances=100000");
  EXPECT_EQ(cell(csv, 1, "psnr_db"), "n/a");
}

TEST(Weather, BudgetStandsBesideNoneWeatherByWeather) {
  const std::vector<Weather> all = weathers_on("");
  const auto within = [](WeatherRun run) {
    run.budget_ms = 50;
    return run;
  };
  const Table table = weather_budget_table(
      {run(all[0], 1, 0.02, 40), within(run(all[0], 1, 0.04, 40)), run(all[0], 2, 0.04, 40),
       within(run(all[0], 2, 0.08, 40)), run(all[1], 1, 0.2, 40), within(run(all[1], 1, 0.4, 40))});
  ASSERT_EQ(table.rows().size(), 4u);
  EXPECT_EQ(cell(table, 0, "FLIP, no budget"), "0.045");
  EXPECT_EQ(cell(table, 0, "FLIP, within"), "0.09");
  EXPECT_EQ(cell(table, 0, "FLIP, worst seed, within"), "0.12");
  EXPECT_EQ(cell(table, 2, "weather"), "median");
  EXPECT_EQ(cell(table, 3, "FLIP, no budget"), "0.3");
  EXPECT_EQ(cell(table, 3, "FLIP, within"), "0.6");
}

TEST(Weather, PanelsAreByScene) {
  const std::vector<Weather> all = weathers_on("");
  const auto panels = weather_panels({run(all[0], 1, 0.02, 40), run(all[8], 1, 0.2, 40),
                                      run(all[1], 1, 0.1, 40), run(all[0], 2, 0.04, 40)});
  ASSERT_EQ(panels.size(), 2u);
  EXPECT_EQ(panels[0].title, "builtin:forest");
  ASSERT_EQ(panels[0].series.size(), 2u);
  EXPECT_EQ(panels[0].series[1].name, all[1].name);
  ASSERT_EQ(panels[0].series[0].points.size(), 2u);
  EXPECT_NEAR(panels[0].series[0].points[1].second, 0.06, 1e-12);  // between the two seeds
}

}  // namespace
}  // namespace mirage::test

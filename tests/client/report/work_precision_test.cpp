// Error against run time: what is run, and where auto stands beside fixed methods.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "client/report/work_precision_rows.h"

namespace mirage::test {
namespace {

const std::vector<std::string> kMethods = {"quad", "depth", "auto", "mesh"};

Figures figures(const Setting& setting, double client_ms, double flip, double bytes_per_s = 1000) {
  Figures f;
  f.setting = setting;
  f.client_ms = client_ms;
  f.flip = flip;
  f.bytes_per_s = bytes_per_s;
  f.spreads = {1.1};
  return f;
}

// The line of auto runs from 10 ms, .1 to 100 ms, .05.
std::vector<Figures> automatic() {
  return {figures({"auto", 1, -1, 16, false}, 10, 0.1),
          figures({"auto", 1, -1, 0, false}, 100, 0.05),
          figures({"auto", 4, -1, 0, false}, 110, 0.07)};
}

TEST(WorkPrecision, FixedMethodsHaveOneSampleAtEveryTauAndFourAtOneAndAutoItsBudgets) {
  for (const bool quick : {false, true}) {
    std::map<std::string, std::set<std::string>> names;  // by method
    int pictured = 0;
    for (const Setting& s : work_sweep(quick, kMethods).settings) {
      EXPECT_TRUE(names[s.method].insert(s.name()).second) << s.name() << " twice";
      EXPECT_EQ(s.automatic(), s.samples < 0) << s.name() << ": a plan is auto's";
      pictured += s.pictured;
    }
    EXPECT_EQ(names.size(), kMethods.size());
    for (const char* method : {"quad", "depth", "mesh"}) EXPECT_EQ(names[method].size(), 3u);
    EXPECT_TRUE(names["auto"].contains("auto within 33 ms"));
    EXPECT_TRUE(names["auto"].contains("auto at tau 1 px"));
    EXPECT_EQ(pictured, 5) << "each method once, auto within a budget, too";
  }
}

TEST(WorkPrecision, LeftOfAutoIsWhatCostsLessAtTheSameError) {
  std::vector<Figures> all = automatic();
  all.push_back(figures({"quad", 1, 4}, 56, 0.075));   // on the line: 55 ms
  all.push_back(figures({"quad", 1, 1}, 40, 0.075));   // left of it
  all.push_back(figures({"mesh", 1, 4}, 500, 0.049));  // no auto has so small an error
  all.push_back(figures({"depth", 4, 1}, 9.5, 0.3));   // cheaper by 5 % than the cheapest of auto
  all.push_back(figures({"depth", 1, 1}, 1, NAN));
  all.back().flip.reset();
  const std::vector<LeftOfAuto> left = left_of_auto(all, Cost::kClientMs, 0.1);
  ASSERT_EQ(left.size(), 2u);
  EXPECT_EQ(left[0].index, 4u);
  EXPECT_NEAR(left[0].auto_cost, 55, 1e-9);
  EXPECT_EQ(left[1].index, 5u);
  EXPECT_TRUE(std::isinf(left[1].auto_cost));
  EXPECT_EQ(left_of_auto(all, Cost::kClientMs, 0).size(), 3u) << "without slack the 5 % count";
}

TEST(WorkPrecision, SentenceSaysWhichStandLeftOfAuto) {
  std::vector<Figures> all = automatic();
  all.push_back(figures({"quad", 1, 4}, 60, 0.075, 2000));
  EXPECT_EQ(say_of_auto(all, Cost::kClientMs, 0.1),
            "By client ms (within 10 %) auto is on or left of every fixed method.");
  all.push_back(figures({"hull", 4, 1}, 20, 0.06, 400));
  const std::string by_ms = say_of_auto(all, Cost::kClientMs, 0.1);
  EXPECT_NE(by_ms.find("1 of 2 settings"), std::string::npos) << by_ms;
  EXPECT_NE(by_ms.find("hull at tau 4 px, 1 sample, 20.0 ms, FLIP 0.0600 (auto: 82.0 ms)"),
            std::string::npos)
      << by_ms;
  EXPECT_NE(say_of_auto(all, Cost::kBytesPerS, 0).find("hull"), std::string::npos);
  for (Figures& f : all) f.client_ms_p95 = 50;
  EXPECT_EQ(say_of_auto(all, Cost::kModelMs, 0),
            "By the device model's ms (95th percentile) auto is on or left of every fixed method.");
}

TEST(WorkPrecision, PlotsHaveALineForEachMethodAndSampleCountAndAFrontOfBothCosts) {
  std::vector<Figures> all = automatic();
  all.push_back(figures({"quad", 1, 4}, 60, 0.075));
  all.push_back(figures({"quad", 1, 1}, 30, 0.08));
  const std::vector<ErrorPlot> plots = error_plots(all, {0.01, {}, {}});
  ASSERT_EQ(plots.size(), 4u);
  EXPECT_EQ(plots[0].id, "e2");
  ASSERT_EQ(plots[0].panels.size(), 4u);
  std::set<std::string> names;
  for (const Series& series : plots[0].panels[0].series) names.insert(series.name);
  EXPECT_EQ(names, (std::set<std::string>{"auto", "auto, by budget", "quad", "quad, 1 sample"}));
  EXPECT_EQ(plots[0].panels[0].front.size(), 4u) << "all but auto at tau 4";
  EXPECT_FALSE(plots[0].panels[1].front.empty()) << "bytes";
  EXPECT_TRUE(plots[0].panels[2].front.empty());
}

TEST(WorkPrecision, RowsEndWithWhatBudgetsAdded) {
  Table table = work_precision_table();
  Figures f = figures({"auto", 1, -1, 50, false}, 40, 0.08);
  f.client_ms_p95 = 48;
  f.frame_setting = FrameSetting{1, 0.75};
  add_rows(table, {f}, {"forest", "abc", "gl", "0123"});
  const std::vector<std::string> end(table.columns().end() - 5, table.columns().end());
  EXPECT_EQ(end, (std::vector<std::string>{"revision", "budget_ms", "client_ms_p95", "scale",
                                           "samples"}));
  const std::vector<std::string>& row = table.rows()[0];
  EXPECT_EQ(std::vector<std::string>(row.end() - 4, row.end()),
            (std::vector<std::string>{"50", "48", "0.75", "1"}));
  EXPECT_EQ(row[table.column("pareto")], "1");
}

}  // namespace
}  // namespace mirage::test

// First seconds: the figures of a run that began with nothing on the screen.
#include <gtest/gtest.h>

#include <cmath>

#include "client/report/first_rows.h"

namespace mirage::test {
namespace {

// Compared every 0.1 s: nothing (FLIP 0.6) until `first_ms`, then 0.2, and 0.1 half a second later.
LatencyRun run(double first_ms, double seconds, const std::string& method = "mirage") {
  LatencyRun run;
  run.scene = "forest";
  run.method = method;
  run.condition.net.rtt_ms = 100;
  run.condition.net.rate_mbps = 20;
  run.first_image_ms = first_ms;
  for (int i = 0; i <= std::lround(10 * seconds); ++i) {
    const double ms = 100.0 * i - first_ms;
    const bool blank = first_ms < 0 || ms < 0;
    run.samples.push_back({0.1 * i, blank ? 0.6 : ms < 500 ? 0.2 : 0.1, 0, 0});
  }
  return run;
}

TEST(FirstSeconds, CountFromTheFirstPicture) {
  const FirstFigures f = first_figures(run(250, 3));
  EXPECT_EQ(f.picture_ms, 250);
  EXPECT_EQ(f.flip, 0.2);                                        // FLIP of the frame after 300 ms
  EXPECT_NEAR(f.second_after, (5 * 0.2 + 5 * 0.1) / 10, 1e-12);  // 0.3 to 1.2 s
}

TEST(FirstSeconds, AComparedFirstPictureIsTheFirst) {
  EXPECT_EQ(first_figures(run(300, 3)).flip, 0.2);
  EXPECT_NEAR(first_figures(run(300, 3)).second_after, (5 * 0.2 + 6 * 0.1) / 11, 1e-12);
}

TEST(FirstSeconds, WhatTheRunIsTooShortForIsNoFigure) {
  const FirstFigures none = first_figures(run(-1, 3));
  EXPECT_TRUE(std::isnan(none.picture_ms) && std::isnan(none.flip) &&
              std::isnan(none.second_after));
  const FirstFigures late = first_figures(run(2500, 3));
  EXPECT_EQ(late.flip, 0.2);
  EXPECT_TRUE(std::isnan(late.second_after));
}

TEST(FirstSeconds, TablesHaveARowForEachRunAndEachFrame) {
  const std::vector<LatencyRun> runs = {run(250, 1), run(-1, 1, "geometry")};
  const Table table = first_table(runs);
  ASSERT_EQ(table.rows().size(), 2u);
  EXPECT_EQ(table.rows()[0][table.column("first_picture_ms")], "250");
  EXPECT_EQ(table.rows()[1][table.column("first_picture_ms")], "n/a");
  EXPECT_EQ(first_frames(runs).rows().size(), 22u);
}

TEST(FirstSeconds, PanelsAreByLinkAndLinesByMethod) {
  std::vector<LatencyRun> runs = {run(250, 1), run(250, 1, "geometry"), run(400, 1)};
  runs[2].condition.net.rtt_ms = 400;
  const std::vector<Panel> panels = first_panels(runs);
  ASSERT_EQ(panels.size(), 2u);
  ASSERT_EQ(panels[0].series.size(), 2u);
  EXPECT_EQ(panels[0].series[1].name, "geometry");
  EXPECT_EQ(panels[1].series[0].points.size(), 11u);
}

// Frames whose pictures the page shows must be among those compared.
TEST(FirstSeconds, PlansCompareATenthOfASecondApart) {
  for (const bool quick : {false, true}) {
    const FirstPlan plan = first_plan(quick);
    EXPECT_DOUBLE_EQ(plan.compare_every / plan.fps, 0.1);
    EXPECT_LT(plan.pictured_link, plan.links.size());
  }
}

}  // namespace
}  // namespace mirage::test

// Frames by the clock: the files of the viewer as rows, plots and words.
#include <gtest/gtest.h>

#include <cmath>

#include "client/report/real_words.h"

namespace mirage::test {
namespace {

constexpr const char* kStatistics =
    R"({"scene": "forest", "budget_ms": 16.0, "scale": 0.5, "samples": 1.0,
        "first_picture_ms": 120.0})";
constexpr const char* kRealTime =
    R"({"drawn": {"frames": 200,
         "ms": {"p50": 12.0, "p95": 20.0, "p99": 30.0, "max": 90.0},
         "ms_after_5s": {"p50": 11.0, "p95": 17.0, "p99": 18.0, "max": 40.0},
         "stage_ms": {"plan": {"p50": 1.0, "p95": 2.0, "p99": 3.0, "max": 5.0},
                      "draw": {"p50": 9.0, "p95": 15.0, "p99": 20.0, "max": 80.0}},
         "late": 12, "late_causes": {"plan": 2, "draw": 10}, "over_3_budgets": 1,
         "placeholder_fraction": 0.25, "placeholder_fraction_after_5s": 0.0},
        "client_renderer": "a card"})";

RealRun walked(double budget_ms, double settled_p95, const std::string& scene = "forest") {
  RealRun run = *read_real_run(kStatistics, kRealTime);
  run.scene = scene;
  run.budget_ms = budget_ms;
  run.settled_ms.p95 = settled_p95;
  return run;
}

TEST(Real, ReadsWhatTheViewerWrites) {
  const std::optional<RealRun> run = read_real_run(kStatistics, kRealTime);
  ASSERT_TRUE(run);
  EXPECT_EQ(run->scene, "forest");
  EXPECT_EQ(run->budget_ms, 16);
  EXPECT_EQ(run->scale, 0.5);
  EXPECT_EQ(run->frames, 200);
  EXPECT_EQ(run->ms.longest, 90);
  EXPECT_EQ(run->settled_ms.p50, 11);
  EXPECT_EQ(run->late, 12);
  EXPECT_EQ(run->very_late, 1);
  ASSERT_EQ(run->stages.size(), 2u);
  EXPECT_EQ(run->worst_stage(), "draw");
  EXPECT_EQ(run->placeholders, 0.25);
  EXPECT_EQ(run->settled_placeholders, 0);
  EXPECT_EQ(run->renderer, "a card");
}

TEST(Real, AFileThatIsNotOfTheViewerIsNoRun) {
  EXPECT_FALSE(read_real_run("", kRealTime));
  EXPECT_FALSE(read_real_run(kStatistics, "{}"));
  EXPECT_FALSE(read_real_run(kStatistics, "{\"drawn\""));
}

TEST(Real, AWalkThatIsTooShortHasNoSettledFigures) {
  const std::optional<RealRun> run = read_real_run(
      kStatistics,
      R"({"drawn": {"frames": 1, "ms_after_5s": {"p50": null, "p95": null, "max": null},
          "late_causes": {}}})");
  ASSERT_TRUE(run);
  EXPECT_TRUE(std::isnan(run->settled_ms.p95));
  EXPECT_FALSE(run->held());
  EXPECT_EQ(real_shortfall(*run),
            "forest within 16 ms: no frame was drawn from the fifth second on.");
  const Table table = real_table({*run});
  EXPECT_EQ(table.rows()[0][table.column("settled_ms_p95")], "n/a");
}

TEST(Real, ABudgetIsHeldUpToATenthMore) {
  EXPECT_TRUE(walked(16, 17.6).held());
  EXPECT_FALSE(walked(16, 17.7).held());
}

TEST(Real, FindsTheSmallestBudgetFromWhichOnAllAreHeld) {
  const auto found = [](const std::vector<RealRun>& runs) { return real_findings(runs)[0]; };
  EXPECT_EQ(found({walked(8, 20), walked(16, 16), walked(50, 30)}).figure, "16 ms");
  EXPECT_EQ(found({walked(8, 8), walked(16, 20), walked(50, 30)}).figure, "50 ms");
  const Finding none = found({walked(16, 16), walked(50, 60)});
  EXPECT_EQ(none.figure, "none");
  EXPECT_TRUE(none.short_of_aim);
}

TEST(Real, FindsTheRestWithinTheLargestBudget) {
  std::vector<RealRun> runs = {walked(16, 16), walked(50, 40), walked(50, 40, "clutter")};
  runs[0].settled_ms.longest = 900;
  runs[2].settled_ms.longest = 160;
  runs[2].settled_placeholders = 0.02;
  const std::vector<Finding> found = real_findings(runs);
  ASSERT_EQ(found.size(), 5u) << "two scenes";
  EXPECT_EQ(found[2].figure, "6.0 %");
  EXPECT_EQ(found[2].what, "of all frames within 50 ms are late, 20 of 24 by draw");
  EXPECT_EQ(found[3].figure, "160 ms");
  EXPECT_EQ(found[4].figure, "2.0 %");
  for (const std::size_t i : {2u, 3u, 4u}) EXPECT_TRUE(found[i].short_of_aim) << i;
}

TEST(Real, SaysWhatARunMisses) {
  RealRun good = walked(50, 40);
  good.very_late = 0;
  EXPECT_EQ(real_shortfall(good), "");
  EXPECT_EQ(
      real_shortfall(walked(50, 40)),
      "forest within 50 ms: 1 of 200 frames take longer than 3 budgets, the first one apart.");
  const std::string late = real_shortfall(walked(16, 20));
  EXPECT_NE(late.find("up to 20.0 ms"), std::string::npos) << late;
  EXPECT_NE(late.find("12 of 200 frames are late, most by draw"), std::string::npos) << late;
  good.settled_placeholders = 0.3;
  EXPECT_NE(real_shortfall(good).find("30.0 % of the objects"), std::string::npos);
}

TEST(Real, TablesHaveARowForEachRunAndEachStage) {
  const std::vector<RealRun> runs = {walked(16, 17), walked(50, 40)};
  EXPECT_EQ(real_table(runs).rows().size(), 2u);
  const Table stages = real_stages(runs);
  ASSERT_EQ(stages.rows().size(), 4u);
  EXPECT_EQ(stages.rows()[1][stages.column("stage")], "draw");
  EXPECT_EQ(stages.rows()[1][stages.column("caused_late")], "10");
}

TEST(Real, PlotsHaveThePanelsOfEachScene) {
  std::vector<RealRun> runs = {walked(16, 17), walked(50, 40), walked(16, 17, "clutter")};
  for (RealRun& run : runs) run.stages[0].late = 0;
  const std::vector<Panel> frames = frame_panels(runs), late = late_panels(runs);
  ASSERT_EQ(frames.size(), 4u) << "whole and settled";
  ASSERT_EQ(frames[0].series.size(), 4u) << "the budget and three figures";
  EXPECT_EQ(frames[0].series[0].points[1], std::make_pair(50.0, 50.0));
  EXPECT_EQ(frames[1].series[2].points[0], std::make_pair(16.0, 17.0));
  ASSERT_EQ(late.size(), 2u);
  ASSERT_EQ(late[0].series.size(), 2u) << "only stages that made a frame late";
  EXPECT_EQ(late[0].series[1].points[0], std::make_pair(16.0, 5.0));
  EXPECT_EQ(picture_panels(runs)[1].series[0].points.size(), 1u);
}

TEST(Real, PlansWalkBeyondTheFifthSecond) {
  for (const bool quick : {false, true}) EXPECT_GT(real_plan(quick).seconds, 5);
}

}  // namespace
}  // namespace mirage::test

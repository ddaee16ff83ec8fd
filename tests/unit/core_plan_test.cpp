// Frame plan: budgets hold, error goes where it is cheapest, and nothing swings.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "client/plan/frame_plan.h"

namespace mirage {
namespace {

constexpr std::int64_t kFrameUs = 50'000;

Camera screen() {
  Camera camera;
  camera.width = 640;
  camera.height = 360;
  return camera;
}

/// A tree of so many triangles that a good tile could stand for.
Alternatives tree(double triangles, double area_px = 4000) {
  Alternatives thing;
  thing.area_px = area_px;
  thing.alpha_tested = true;
  thing.triangles = triangles;
  thing.mesh_px = 0.5;
  thing.flat = Alternatives::Tile{4, 1, 0.6};
  return thing;
}

std::vector<Alternatives> forest(int count) {
  std::vector<Alternatives> out;
  for (int i = 0; i < count; ++i) out.push_back(tree(2000 + 500 * (i % 7), 1000 + 300 * (i % 11)));
  return out;
}

/// Prices under which what follows can be told by hand: each kind as on a software renderer.
CostModel prices() { return *device_model("software"); }

/// What the things take that the plan chooses from, by its prices.
double drawn_ms(const FramePlan& plan, const std::vector<Alternatives>& things,
                std::vector<bool>& as_mesh) {
  const CostModel p = prices();
  Camera drawn = screen();
  drawn.width = static_cast<std::uint32_t>(drawn.width * plan.setting().scale);
  drawn.height = static_cast<std::uint32_t>(drawn.height * plan.setting().scale);
  FrameWork work = target_work(drawn, plan.setting().samples);
  const double shrunk = plan.setting().scale * plan.setting().scale;
  const int more = plan.setting().samples - 1;
  as_mesh.resize(things.size());
  for (std::size_t i = 0; i < things.size(); ++i) {
    as_mesh[i] = plan.mesh_pays(things[i], as_mesh[i]);
    if (as_mesh[i]) {
      work[Work::kTestedTriangle] += things[i].triangles;
      work[Work::kTestedTriangleSample] += things[i].triangles * more;
      work[Work::kTestedPixel] += shrunk * things[i].area_px;
      work[Work::kTestedSample] += shrunk * things[i].area_px * more;
    } else {
      work[Work::kFlatPixel] += shrunk * things[i].area_px * things[i].flat->share;
      work[Work::kImpostorSample] += shrunk * things[i].area_px * things[i].flat->share * more;
    }
  }
  return p.ms_of(work);
}

TEST(CorePlan, BudgetsHoldAndBuyLessErrorTheLargerTheyAre) {
  const std::vector<Alternatives> things = forest(40);
  double before = std::numeric_limits<double>::infinity();
  for (const double budget : {20.0, 33.0, 50.0, 100.0, 200.0, 1000.0}) {
    FramePlan plan(budget, -1);
    plan.set_prices(prices());
    std::vector<bool> as_mesh;
    double ms = 0;
    int changed = 0;
    for (int frame = 0; frame < 100; ++frame) {
      plan.finish(screen(), things, 1, frame * kFrameUs);
      const std::vector<bool> last = as_mesh;
      ms = drawn_ms(plan, things, as_mesh);
      plan.note_drawn(ms);
      if (frame >= 60 && last != as_mesh) ++changed;
    }
    EXPECT_LE(ms, 1.1 * budget);
    EXPECT_EQ(changed, 0) << "budget " << budget << ": it swings";
    EXPECT_LE(plan.lambda(), before) << "budget " << budget;
    before = plan.lambda();
  }
  EXPECT_EQ(before, 0) << "what everything fits in has no price";
}

TEST(CorePlan, TheCheapestErrorGoesFirst) {
  std::vector<Alternatives> things = {tree(2000), tree(20'000), tree(2000, 100)};
  for (int i = 0; i < 30; ++i) things.push_back(tree(6000));
  FramePlan plan(40, 1);
  plan.set_prices(prices());
  for (int i = 0; i < 30; ++i) plan.finish(screen(), things, 1, i * kFrameUs);
  ASSERT_GT(plan.lambda(), 0);
  EXPECT_TRUE(plan.mesh_pays(things[0], false));
  EXPECT_FALSE(plan.mesh_pays(things[1], false)) << "the same for ten times the triangles";
  EXPECT_FALSE(plan.mesh_pays(things[2], false)) << "a fortieth of the area";
}

TEST(CorePlan, WithoutABudgetOrPricesNothingIsPlanned) {
  FramePlan none(0, -1), unpriced(50, -1);
  none.set_prices(prices());
  for (FramePlan* plan : {&none, &unpriced}) {
    plan->finish(screen(), forest(10), 1, 0);
    plan->note_drawn(500);
    EXPECT_FALSE(plan->plans());
    EXPECT_EQ(plan->setting().samples, 4);
    EXPECT_EQ(plan->setting().scale, 1);
    EXPECT_EQ(plan->lambda(), 0);
  }
}

TEST(CorePlan, SamplesThatAreSaidStay) {
  for (const int samples : {0, 1, 2, 4, 16}) {
    FramePlan plan(10, samples);
    plan.set_prices(prices());
    for (int i = 0; i < 40; ++i) plan.finish(screen(), forest(40), 1, i * kFrameUs);
    EXPECT_EQ(plan.setting().samples, std::max(samples, 1));
    EXPECT_TRUE(samples <= 1 || plan.setting().scale == 1);
  }
}

TEST(CorePlan, NonsenseIsHarmless) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double budget : {0.01, 50.0, 10'000.0}) {
    FramePlan plan(budget, -1);
    plan.set_prices(prices());
    for (int i = 0; i < 50; ++i) {
      plan.finish(screen(), forest(300), 1, i % 2 ? i * kFrameUs : 0);
      for (const double ms : {nan, -1.0, 0.0, HUGE_VAL, 1e300}) plan.note_drawn(ms);
      EXPECT_FALSE(std::isnan(plan.lambda()));
      EXPECT_TRUE(std::isfinite(plan.expected_ms()));
      if (budget == 50 && i > 0) {
        EXPECT_LE(plan.expected_ms(), budget);
      }
    }
    plan.finish(screen(), {}, 0, 0);
  }
  FramePlan tiny(0.01, -1);
  tiny.set_prices(prices());
  for (int i = 0; i < 50; ++i) tiny.finish(screen(), forest(20), 1, i * kFrameUs);
  EXPECT_EQ(tiny.setting().samples, 1);
  EXPECT_EQ(tiny.setting().scale, 0.5) << "as near as there is";
  EXPECT_FALSE(tiny.mesh_pays(forest(1)[0], true));
}

TEST(CorePlan, WhatOneStandsInIsDrawnWhateverItCosts) {
  Alternatives ground = tree(1'000'000, 200'000);
  ground.flat.reset();
  ground.mesh_only = true;
  FramePlan plan(1, -1);
  plan.set_prices(prices());
  for (int i = 0; i < 20; ++i) plan.finish(screen(), {ground, tree(100)}, 2, i * kFrameUs);
  EXPECT_TRUE(plan.mesh_pays(ground, false));
  EXPECT_GT(plan.expected_ms(), 100) << "and counted";
}

TEST(CorePlan, AStrainThatPassesIsForgotten) {
  FramePlan plan(50, 1);
  plan.set_prices(prices());
  const std::vector<Alternatives> things = forest(40);
  const auto settle = [&](double times, int frames) {
    static std::int64_t now = 0;
    for (int i = 0; i < frames; ++i) {
      plan.finish(screen(), things, 1, now += kFrameUs);
      plan.note_drawn(times * plan.expected_ms());
    }
    return plan.expected_ms();
  };
  const double usual = settle(1, 60), strained = settle(1.5, 60), back = settle(1, 40);
  EXPECT_LT(strained, 0.85 * usual);
  EXPECT_GT(back, 0.9 * usual);
}

// What is out of the list for a frame (not resident, turned away from) comes back.
TEST(CorePlan, ThePriceOfErrorDoesNotCollapseForAFrame) {
  const std::vector<Alternatives> all = forest(60);
  std::vector<Alternatives> few = all;
  for (Alternatives& thing : few) thing.mesh_px.reset();
  FramePlan plan(40, 1);
  plan.set_prices(prices());
  for (int i = 0; i < 40; ++i) plan.finish(screen(), all, 1, i * kFrameUs);
  const double before = plan.lambda();
  ASSERT_GT(before, 0);
  plan.finish(screen(), few, 1, 40 * kFrameUs);
  EXPECT_GE(plan.lambda(), 0.7 * before);
  for (int i = 41; i < 200; ++i) plan.finish(screen(), few, 1, i * kFrameUs);
  EXPECT_EQ(plan.lambda(), 0) << "in time it does";
}

TEST(CorePlan, WhatIsDrawnStaysUnlessAnotherIsClearlyBetter) {
  const std::vector<Alternatives> things = forest(60);
  FramePlan plan(40, 1);
  plan.set_prices(prices());
  for (int i = 0; i < 40; ++i) plan.finish(screen(), things, 1, i * kFrameUs);
  int between = 0;
  for (double triangles = 100; triangles < 1e5; triangles *= 1.05) {
    const bool starts = plan.mesh_pays(tree(triangles), false);
    const bool stays = plan.mesh_pays(tree(triangles), true);
    EXPECT_TRUE(stays || !starts);
    between += stays && !starts;
  }
  EXPECT_GE(between, 3) << "15 % and more of the way";
}

TEST(CorePlan, AMillionThingsArePlanned) {
  FramePlan plan(50, 1);
  plan.set_prices(prices());
  const std::vector<Alternatives> things(1'000'000, tree(100, 10));
  for (int i = 0; i < 2; ++i) plan.finish(screen(), things, 1, i * kFrameUs);
  EXPECT_TRUE(std::isfinite(plan.lambda()));
}

}  // namespace
}  // namespace mirage

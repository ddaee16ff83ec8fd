// Prices: the work of drawing, what it costs, and the running fit.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "client/frame/planned_frame.h"
#include "client/price/cost_fit.h"
#include "protocol/model/need_mask.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

constexpr double kPi = 3.14159265358979;

Camera straight() {
  Camera camera;
  camera.width = 640;
  camera.height = 360;
  camera.pose = look_at({0, 0, 0}, {0, 0, -1});
  return camera;
}

TEST(CorePrice, AreaIsThatOfTheDiscAsFarAsItIsInView) {
  const Camera camera = straight();
  const double screen = 640.0 * 360;
  const double half = camera.focal_px() * 1 / std::sqrt(100.0 - 1);
  EXPECT_NEAR(shown_area_px(camera, {0, 0, -10}, 1), kPi * half * half, 1e-3);
  const double edge = 10 * 320 / camera.focal_px();  // the view's right edge at this depth
  const double far = std::sqrt(100 + edge * edge);
  const double ellipse =
      kPi * std::pow(camera.focal_px(), 2) * std::sqrt(far * far - 1) / std::pow(100.0 - 1, 1.5);
  EXPECT_NEAR(shown_area_px(camera, {edge, 0, -10}, 1), ellipse / 2, 1);
  EXPECT_EQ(shown_area_px(camera, {0, 0, 10}, 1), 0) << "behind";
  EXPECT_EQ(shown_area_px(camera, {100, 0, -10}, 1), 0) << "beside";
  EXPECT_EQ(shown_area_px(camera, {0.2, 0, -0.3}, 1), screen) << "around the eye";
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(shown_area_px(camera, {0, 0, -10}, bad), 0);
  }
}

TEST(CorePrice, WorkIsWhatIsDrawn) {
  SelectorWorld world = one_ball(true);
  ObjectDescription& object = world.scene.objects[0];
  object.lods = {LodInfo{1000, 8000, 0, 0}, LodInfo{50, 800, 0.1f, 0}};
  world.look({0, 0, 20}, {0, 0, 0});
  DrawList list;
  list.meshes.push_back({0, 1, 1.0f});
  const FrameWork opaque = work_of({world.camera, &world.scene, list, {}}, world.camera, 4);
  const double pixels = static_cast<double>(world.camera.width) * world.camera.height;
  EXPECT_EQ(opaque[Work::kFrame], 1);
  EXPECT_EQ(opaque[Work::kPixel], pixels);
  EXPECT_EQ(opaque[Work::kSample], 3 * pixels);
  EXPECT_EQ(opaque[Work::kMesh], 1);
  EXPECT_EQ(opaque[Work::kTriangle], 50);
  EXPECT_GT(opaque[Work::kMeshPixel], 0);
  EXPECT_EQ(opaque[Work::kTestedTriangle], 0);
  object.needs |= kNeedAlphaMask;
  const FrameWork tested = work_of({world.camera, &world.scene, list, {}}, world.camera, 4);
  EXPECT_EQ(tested[Work::kTestedTriangle], 50);
  EXPECT_EQ(tested[Work::kTestedTriangleSample], 150);
  EXPECT_EQ(tested[Work::kTestedSample], 3 * tested[Work::kTestedPixel]);
  EXPECT_EQ(tested[Work::kTestedPixel], opaque[Work::kMeshPixel]);
  EXPECT_EQ(tested[Work::kTriangle], 0);
  list.meshes.push_back({0, 1, 1.0f});
  EXPECT_EQ(work_of({world.camera, &world.scene, list, {}}, world.camera, 1)[Work::kMesh], 1)
      << "once a level";
  ASSERT_TRUE(world.add_tile(0));
  const DrawList tiles = world.select(world.input());
  ASSERT_EQ(tiles.impostors.size(), 1u);
  const FrameWork tile = work_of({world.camera, &world.scene, tiles, {}}, world.camera, 1);
  EXPECT_GT(tile[Work::kFlatPixel], 0);
  EXPECT_LE(tile[Work::kFlatPixel], opaque[Work::kMeshPixel] * 1.001);
  EXPECT_EQ(tile[Work::kImpostorSample], 0);
}

TEST(CorePrice, EveryModelHasPricesAndUnknownNamesHaveNone) {
  for (const std::string& name : device_model_names()) {
    const std::optional<CostModel> model = device_model(name);
    ASSERT_TRUE(model) << name;
    FrameWork one;
    one.amount.fill(1);
    EXPECT_GT(model->ms_of(one), 0) << name;
    for (const double ms : model->ms) EXPECT_TRUE(std::isfinite(ms) && ms > 0) << name;
  }
  EXPECT_FALSE(device_model("toaster"));
}

/// Adds frames of a machine on which everything costs `times` what `model` says.
void frames_of(CostFit& fit, const CostModel& model, double times, int count) {
  for (int i = 0; i < count; ++i) {
    FrameWork work;
    work[Work::kFrame] = 1;
    work[Work::kPixel] = 230'400;
    work[Work::kTriangle] = 20'000.0 * (i % 5);
    work[Work::kFlatPixel] = 10'000.0 * (i % 3);
    fit.add(work, times * model.ms_of(work));
  }
}

FrameWork some_frame() {
  FrameWork work;
  work[Work::kFrame] = 1;
  work[Work::kPixel] = 230'400;
  work[Work::kTriangle] = 37'000;
  work[Work::kFlatPixel] = 12'000;
  return work;
}

TEST(CorePrice, TheFitFollowsTheMachine) {
  const CostModel model = *device_model("software");
  CostFit fit(model);
  frames_of(fit, model, 3, 60);
  const double expected = 3 * model.ms_of(some_frame());
  EXPECT_NEAR(fit.model().ms_of(some_frame()), expected, 0.05 * expected);
  EXPECT_NEAR(fit.model()[Work::kTestedSample], model[Work::kTestedSample],
              1e-3 * model[Work::kTestedSample])
      << "of what was never drawn nothing is known";
  frames_of(fit, model, 0.5, 400);
  EXPECT_NEAR(fit.model().ms_of(some_frame()), expected / 6, 0.1 * expected / 6) << "and back";
}

TEST(CorePrice, WhatIsNoPriceDoesNotCount) {
  const CostModel model = *device_model("software");
  CostFit fit(model);
  frames_of(fit, model, 1, 60);
  const double before = fit.model().ms_of(some_frame());
  for (const double ms : {0.0, -5.0, std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::infinity()}) {
    fit.add(some_frame(), ms);
    EXPECT_EQ(fit.model().ms_of(some_frame()), before) << ms;
  }
  fit.add(some_frame(), 3'600'000);  // the machine was suspended
  EXPECT_NEAR(fit.model().ms_of(some_frame()), before, 0.2 * before);
  for (int i = 0; i < 5; ++i) fit.add(some_frame(), 20 * before);
  EXPECT_LT(fit.model().ms_of(some_frame()), 2 * before) << "a few stalls";
}

TEST(CorePrice, PricesStayWithinTheirLimits) {
  const CostModel model = *device_model("software");
  CostFit fit(model);
  frames_of(fit, model, 1e6, 200);
  for (std::size_t i = 0; i < kWorks; ++i) {
    EXPECT_LE(fit.model().ms[i], model.ms[i] * 16 * (1 + 1e-9));
    EXPECT_GE(fit.model().ms[i], model.ms[i] / 16 * (1 - 1e-9));
  }
}

}  // namespace
}  // namespace mirage::test

// Selector: geometry instead of tiles, and tiles in the place of geometry.
#include <gtest/gtest.h>

#include <algorithm>

#include "client/plan/selector_rules.h"
#include "protocol/model/need_mask.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

TEST(CoreSelectorGeometry, GeometrySmallerThanATileIsDrawnEverywhere) {
  SelectorWorld world = one_ball(true);
  ObjectDescription& object = world.scene.objects[0];
  object.lods = {LodInfo{12, 800, 0, 0}};
  world.look({0, 0, 60}, {0, 0, 0});
  EXPECT_EQ(world.selector.mesh_needs(world.input()).instances, std::vector<std::uint32_t>{0});
  EXPECT_EQ(world.selector.needs(world.input()).size(), 1u) << "until it is there";
  world.mesh_ready[0] = true;
  EXPECT_EQ(world.select(world.input()).meshes.size(), 1u);
  EXPECT_TRUE(world.selector.needs(world.input()).empty());
  object.needs |= kNeedBaseColorMap;
  EXPECT_TRUE(world.selector.mesh_needs(world.input()).instances.empty())
      << "its images are not small";
  object.needs = 0;
  object.lods[0].bytes = 20'000;
  EXPECT_TRUE(world.selector.mesh_needs(world.input()).instances.empty());
}

// Geometry is drawn up to the distance that the experiments' limit allows.
TEST(CoreSelectorGeometry, NearGeometryReplacesTheImpostor) {
  SelectorWorld world = one_ball(true);
  const auto input = [&] {
    SelectorInput in = world.input();
    in.mesh_radii = 8;
    return in;
  };
  world.look({0, 0, 1.9}, {0, 0, 0});
  EXPECT_EQ(world.selector.mesh_needs(input()).instances, std::vector<std::uint32_t>{0});
  world.look({0, 0, 2.1}, {0, 0, 0});
  EXPECT_TRUE(world.selector.mesh_needs(input()).instances.empty()) << "unless it is bought";
  world.mesh_ready[0] = true;
  world.look({0, 0, 7.9}, {0, 0, 0});
  const DrawList near = world.select(input());
  ASSERT_EQ(near.meshes.size(), 1u);
  EXPECT_EQ(near.meshes[0].instance, 0u);
  EXPECT_TRUE(near.impostors.empty());
  EXPECT_EQ(near.over_tau, 0u);
  EXPECT_TRUE(world.selector.needs(input()).empty());
  world.look({0, 0, 9.1}, {0, 0, 0});
  EXPECT_EQ(world.select(input()).meshes.size(), 1u) << "hysteresis";
  world.look({0, 0, 9.3}, {0, 0, 0});
  world.frame += 2;  // out of view in between, so that nothing fades
  EXPECT_TRUE(world.select(input()).meshes.empty());
  EXPECT_EQ(world.selector.needs(input()).size(), 1u);
  world.frame += 2;
  world.look({0, 0, 9.1}, {0, 0, 0});
  EXPECT_TRUE(world.select(input()).meshes.empty()) << "hysteresis";
  world.frame += 2;
  EXPECT_EQ(world.select(world.input()).meshes.size(), 1u) << "without a limit";
}

TEST(CoreSelectorGeometry, GeometryFadesInOverTheTileAndTheTileOverIt) {
  SelectorWorld world = one_ball(true);
  world.look({0, 0, 9.6}, {0, 0, 0});
  ASSERT_TRUE(world.add_tile(0));
  world.mesh_ready[0] = true;
  const auto at = [&](double distance, std::int64_t us) {
    world.look({0.8, 0, distance}, {0, 0, 0});
    world.now_us += us;
    ++world.frame;
    SelectorInput in = world.input();
    in.march_budget_px = 0;  // flat, and over tau
    in.mesh_radii = 8;
    return world.select(in);
  };
  EXPECT_TRUE(at(9.6, 16'000).meshes.empty());
  DrawList list = at(7.9, 16'000);
  ASSERT_EQ(list.meshes.size(), 1u);
  ASSERT_EQ(list.impostors.size(), 1u) << "whole, underneath";
  EXPECT_EQ(list.impostors[0].fade, 1);
  EXPECT_EQ(list.meshes[0].fade, 0);
  EXPECT_GT(list.impostors[0].bound_px, 1);
  EXPECT_EQ(list.over_tau, 1u) << "the tile shows";
  list = at(7.9, 60'000);
  EXPECT_NEAR(list.meshes[0].fade, 0.5, 1e-6);
  ASSERT_EQ(list.impostors.size(), 1u);
  EXPECT_EQ(list.over_tau, 0u) << "geometry covers it";
  list = at(7.9, 60'000);
  EXPECT_EQ(list.meshes[0].fade, 1);
  EXPECT_TRUE(list.impostors.empty());
  list = at(9.6, 16'000);
  ASSERT_EQ(list.meshes.size(), 1u) << "whole, underneath";
  EXPECT_EQ(list.meshes[0].fade, 1);
  list = at(9.6, 60'000);
  ASSERT_EQ(list.impostors.size(), 1u);
  EXPECT_NEAR(list.impostors[0].fade, 0.5, 1e-6);
  list = at(9.6, 60'000);
  EXPECT_TRUE(list.meshes.empty());
}

TEST(CoreSelectorGeometry, TilesStandInForGeometryThatTheBudgetDoesNotHold) {
  SelectorWorld world = one_ball(true);
  world.mesh_ready[0] = true;
  world.look({0, 0, 5}, {0, 0, 0});
  FramePlan plan(100, 1);
  plan.set_prices(*device_model("software"));
  const auto input = [&] {
    world.frame += 2;  // out of view in between, so that nothing fades
    SelectorInput in = world.input();
    in.plan = &plan;
    in.now_us = world.now_us += 1'000'000;
    return in;
  };
  std::uint32_t& triangles = world.scene.objects[0].triangles;
  world.scene.objects[0].lods = {LodInfo{100, 40'000, 0, 0}};
  EXPECT_EQ(world.select(input(), plan).meshes.size(), 1u);
  EXPECT_TRUE(world.selector.needs(input()).empty()) << "so few triangles cost less";
  world.scene.objects[0].lods[0].triangles = triangles = 3'000'000;
  EXPECT_TRUE(world.select(input(), plan).meshes.empty()) << "a placeholder is in time";
  EXPECT_EQ(world.selector.needs(input()).size(), 1u);
  EXPECT_TRUE(world.selector.mesh_needs(input()).instances.empty());
  ASSERT_TRUE(world.add_tile(0));
  const DrawList still = world.select(input(), plan);
  EXPECT_TRUE(still.meshes.empty());
  EXPECT_EQ(still.impostors.size(), 1u);
  EXPECT_TRUE(world.selector.needs(input()).empty());
  SelectorInput any_time = input();
  any_time.plan = &world.any_time;
  EXPECT_EQ(world.select(any_time).meshes.size(), 1u) << "it errs less";
}

// Geometry is compared with the tile that would be shown, not with a fresh one.
TEST(CoreSelectorGeometry, ATileAgesWhileTheNextIsOnItsWay) {
  EXPECT_DOUBLE_EQ(aged_tile_px(1, 4), 2) << "it lives longer than that takes";
  EXPECT_DOUBLE_EQ(aged_tile_px(1, 0.0625), 5) << "four lives";
  EXPECT_DOUBLE_EQ(aged_tile_px(3, 0.0625), 15);
  EXPECT_DOUBLE_EQ(aged_tile_px(1, 0.001), 8) << "then a placeholder is as good";
}

// A budget that the fixed work of every frame uses up leaves no time for geometry, however cheap. A
// tile is asked for.
TEST(CoreSelectorGeometry, WhatThereIsNoTimeForIsAskedForAsATile) {
  SelectorWorld world = one_ball(true);
  world.mesh_ready[0] = true;
  world.scene.objects[0].lods = {LodInfo{100, 40'000, 0, 0}};
  world.look({0, 0, 5}, {0, 0, 0});
  for (const double budget_ms : {100.0, 0.001}) {
    FramePlan plan(budget_ms, 1);
    plan.set_prices(*device_model("software"));
    world.frame += 2;
    SelectorInput in = world.input();
    in.plan = &plan;
    in.now_us = world.now_us += 1'000'000;
    const bool drawn = !world.select(in, plan).meshes.empty();
    EXPECT_EQ(drawn, budget_ms > 1);
    const std::vector<TileNeed> needs = world.selector.needs(in);
    ASSERT_EQ(needs.size(), drawn ? 0u : 1u);
  }
}

TEST(CoreSelectorGeometry, SurroundingsAreGeometry) {
  std::vector<Placed> placed{{{0, 0, 0}, 50, 1}};  // a hall
  for (int i = 0; i < 20; ++i) placed.push_back({{i - 10.0, 0, -4}, 0.5f, 0});
  SceneOptions options;
  options.objects = 2;
  options.geometry = true;
  options.surrounds = {1};
  SelectorWorld world(make_scene(placed, options));
  world.look({0, 0, -3}, {0, 0, -4});
  EXPECT_TRUE(world.scene.objects[1].surrounds);
  EXPECT_FALSE(world.scene.objects[0].surrounds);
  const std::vector<std::uint32_t> wanted = world.selector.mesh_needs(world.input()).instances;
  EXPECT_EQ(std::count(wanted.begin(), wanted.end(), 0u), 1);
  for (const TileNeed& need : world.selector.needs(world.input())) EXPECT_NE(need.instance, 0u);
  world.mesh_ready[1] = true;
  const DrawList list = world.select(world.input());
  ASSERT_EQ(list.meshes.size(), 1u);
  EXPECT_EQ(list.meshes[0].instance, 0u);
}

}  // namespace
}  // namespace mirage::test

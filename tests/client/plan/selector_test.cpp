// Selector: the bound alone decides what is drawn and what is asked for.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

double log_uniform(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> u(std::log(low), std::log(high));
  return std::exp(u(random));
}

ViewGeometry view_from(const glm::dvec3& eye, double radius, double focal) {
  ViewGeometry view;
  view.eye = eye;
  view.radius = radius;
  view.focal_px = focal;
  view.center_depth = glm::length(eye);
  view.forward = -safe_normalize(eye);
  return view;
}

glm::dvec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> n;
  return safe_normalize({n(random), n(random), n(random)});
}

TEST(CoreSelector, CaptureOfTheAskedKeyServesItsWholeCell) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  int tried = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double r = log_uniform(random, 1e-3, 1e3), d = r * log_uniform(random, 2, 1000);
    const double tau = log_uniform(random, 0.25, 4), focal = log_uniform(random, 200, 4000);
    ViewPlan plan;
    plan.tau_px = tau;
    const TileNeed need = need_for_view(view_from(d * random_direction(random), r, focal), plan);
    ASSERT_TRUE(valid(need.cell));
    ASSERT_TRUE(valid(need.distance));
    // Even the finest keys may be too coarse for the request.
    if (need.cell.level >= limits::kMaxViewLevel - 1) continue;
    if (need.distance.level >= limits::kMaxDistanceLevel) continue;
    ++tried;
    const Capture capture = capture_for(need, r);
    const double q = capture.distance * r / tangent_length(capture.distance, r);
    for (int k = 0; k < 8; ++k) {
      const int finer = limits::kMaxViewLevel - need.cell.level;
      const auto inside = [&](std::uint16_t index) {
        const double at = unit(random) * ((1 << finer) - 1);
        return static_cast<std::uint16_t>((index << finer) + std::lround(at));
      };
      const ViewCell at{limits::kMaxViewLevel, inside(need.cell.x), inside(need.cell.y)};
      const double radii = std::exp2((need.distance.index + unit(random)) /
                                     static_cast<double>(1 << need.distance.level));
      const ViewGeometry view = view_from(direction_from_view_cell(at) * (radii * r), r, focal);
      const double dc = capture.distance;
      const DrawnDepth drawn{0.5 * r, q, dc - 0.5 * r, dc + 0.5 * r, dc, dc};
      ASSERT_LE(position_bound_px(view, capture.geometry(), drawn), tau)
          << "d/r " << d / r << " radii " << radii << " tau " << tau << " focal " << focal
          << " levels " << int{need.cell.level} << " " << int{need.distance.level};
    }
  }
  EXPECT_GT(tried, 15'000);
}

TEST(CoreSelector, TexelsKeepUpWithPixels) {
  std::mt19937 random(12);
  int tried = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double r = log_uniform(random, 1e-2, 1e2), d = r * log_uniform(random, 1.3, 2000);
    const ViewGeometry view =
        view_from(d * random_direction(random), r, log_uniform(random, 200, 2000));
    const TileNeed need = need_for_view(view, ViewPlan{});
    ASSERT_LE(tile_edge(need.size_class), 1024u);
    if (tile_edge(need.size_class) == 1024) continue;  // capped
    const Capture capture = capture_for(need, r);
    // Compares texels over the ball's diameter with its pixels, both at the depth of the centre.
    const double texel_px = view.focal_px * capture.texel_width(capture.distance) / d;
    const double content = static_cast<double>(capture.edge - 2) / capture.edge;
    ASSERT_GE(1 / (texel_px * content), 1.4) << "edge " << capture.edge << " d/r " << d / r;
    ++tried;
  }
  EXPECT_GT(tried, 10'000);
}

TEST(CoreSelector, TurningTheHeadKeepsTheKey) {
  SelectorWorld world = one_ball();
  const auto need = [&] {
    return need_for_view(
        view_geometry(world.camera, world.scene.instances[0], world.scene.objects[0]), ViewPlan{});
  };
  const TileNeed ahead = need();
  for (double yaw = -0.8; yaw <= 0.8; yaw += 0.05) {
    world.look({0, 0, 5}, glm::dvec3(0, 0, 5) + glm::dvec3(std::sin(yaw), 0.2, -std::cos(yaw)));
    const TileNeed turned = need();
    EXPECT_EQ(turned.cell, ahead.cell);
    EXPECT_EQ(turned.distance, ahead.distance);
    EXPECT_EQ(turned.size_class, ahead.size_class);
  }
}

TEST(CoreSelector, NoTileIsAPlaceholderAndACoarseNeed) {
  SelectorWorld world = one_ball();
  const DrawList list = world.select(world.input());
  EXPECT_EQ(list.visible, 1u);
  EXPECT_EQ(list.over_tau, 1u);
  ASSERT_EQ(list.placeholders.size(), 1u);
  EXPECT_NEAR(list.placeholders[0].distance, 5, 1e-12);
  EXPECT_TRUE(list.impostors.empty());
  const auto needs = world.selector.needs(world.input());
  ASSERT_EQ(needs.size(), 1u);
  const TileNeed fine = need_for_view(
      view_geometry(world.camera, world.scene.instances[0], world.scene.objects[0]), ViewPlan{});
  EXPECT_EQ(needs[0].cell, fine.cell);
  EXPECT_LT(needs[0].size_class, fine.size_class);
  EXPECT_GT(needs[0].gain, 0);
}

// Planning a frame that is not drawn (for its price, or to explain it) leaves no trace.
TEST(CoreSelector, SelectingWritesNothingIntoTheCache) {
  SelectorWorld world = one_ball();
  const TileRecordPtr tile = world.add_tile(0);
  const std::uint64_t before = tile->last_drawn;
  world.frame += 3;
  ASSERT_EQ(world.only_select(world.input()).impostors.size(), 1u);
  EXPECT_EQ(tile->last_drawn, before);
  EXPECT_FALSE(tile->shown);
}

TEST(CoreSelector, TileOfThePresentViewIsEnough) {
  SelectorWorld world = one_ball();
  const TileRecordPtr tile = world.add_tile(0);
  ASSERT_TRUE(tile);
  const DrawList list = world.select(world.input());
  ASSERT_EQ(list.impostors.size(), 1u);
  EXPECT_EQ(list.impostors[0].tile, tile);
  EXPECT_EQ(list.impostors[0].method, DrawMethod::kQuad);
  EXPECT_LE(list.impostors[0].bound_px, 1);
  EXPECT_EQ(list.impostors[0].fade, 1);
  EXPECT_EQ(list.over_tau, 0u);
  EXPECT_EQ(tile->last_drawn, world.frame);
  EXPECT_TRUE(tile->shown);
  EXPECT_TRUE(world.selector.needs(world.input()).empty());
}

TEST(CoreSelector, InstancesOutOfViewOrTooSmallAreNothing) {
  SelectorWorld world = one_ball();
  world.look({0, 0, 5}, {0, 0, 10});
  EXPECT_EQ(world.select(world.input()).visible, 0u);
  EXPECT_TRUE(world.selector.needs(world.input()).empty());
  world.look({0, 0, 1000}, {0, 0, 0});  // 0.3 px
  EXPECT_EQ(world.select(world.input()).visible, 0u);
  EXPECT_TRUE(world.selector.needs(world.input()).empty());
}

TEST(CoreSelector, InsideTheSwapDistanceEveryBoundIsInfinite) {
  SelectorWorld world = one_ball();
  world.look({0, 0, 1.15}, {0, 0, 0});
  ASSERT_EQ(world.selector.needs(world.input()).size(), 1u) << "one, as a stopgap";
  ASSERT_TRUE(world.add_tile(0));
  const DrawList list = world.select(world.input());
  ASSERT_EQ(list.impostors.size(), 1u);
  EXPECT_TRUE(std::isinf(list.impostors[0].bound_px));
  EXPECT_EQ(list.over_tau, 1u);
  EXPECT_TRUE(world.selector.needs(world.input()).empty()) << "no second";
}

TEST(CoreSelector, MarchingKeepsToItsBudget) {
  SelectorWorld world = one_ball();
  ASSERT_TRUE(world.add_tile(0));
  world.look({0.6, 0, 5}, {0, 0, 0});  // off the cell: the flat proxy is not good enough
  SelectorInput in = world.input();
  const DrawList rich = world.select(in);
  ASSERT_EQ(rich.impostors.size(), 1u);
  EXPECT_EQ(rich.impostors[0].method, DrawMethod::kDepth);
  in.march_budget_px = 0;
  const DrawList poor = world.select(in);
  ASSERT_EQ(poor.impostors.size(), 1u);
  EXPECT_NE(poor.impostors[0].method, DrawMethod::kDepth);
  EXPECT_GT(poor.impostors[0].bound_px, rich.impostors[0].bound_px);
}

TEST(CoreSelector, FixedMethodIsKept) {
  SelectorWorld world = one_ball();
  ASSERT_TRUE(world.add_tile(0));
  SelectorInput in = world.input();
  in.method.automatic = false;
  for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kCuboid, DrawMethod::kDepth}) {
    in.method.method = method;
    const DrawList list = world.select(in);
    ASSERT_EQ(list.impostors.size(), 1u);
    EXPECT_EQ(list.impostors[0].method, method);
  }
}

TEST(CoreSelector, ObjectWithoutAHullIsNotDrawnOnOne) {
  SelectorWorld world = one_ball();
  ASSERT_TRUE(world.scene.objects[0].hull.vertices.empty());
  world.add_tile(0, [](TileMeasure& m) { m.dz_hull = 0; });  // a perfect measure does not help
  world.look({0.6, 0, 5}, {0, 0, 0});
  SelectorInput in = world.input();
  in.march_budget_px = 0;
  const DrawList list = world.select(in);
  ASSERT_EQ(list.impostors.size(), 1u);
  EXPECT_EQ(list.impostors[0].method, DrawMethod::kQuad);
}

TEST(CoreSelector, LargeFoliageDrawnAsReliefIsAskedForInLayersWhileTheEyeMoves) {
  const auto asked = [](NeedMask needs, double distance, double speed, bool first,
                        bool automatic = false) {
    SceneOptions options;
    options.needs = needs;
    SelectorWorld world(make_scene({{{0, 0, 0}}}, options));
    world.look({0, 0, distance}, {0, 0, 0});
    if (!first) world.add_tile(0, [](TileMeasure& m) { m.depth_gap = 1; });  // much is hidden
    world.look({0.5 * distance, 0, distance}, {0, 0, 0});
    SelectorInput in = world.input();
    in.velocity = {speed, 0, 0};
    in.method.automatic = automatic;
    in.method.method = DrawMethod::kDepth;
    const std::vector<TileNeed> found = world.selector.needs(in);
    return found.empty() ? 0 : found[0].channels;
  };
  EXPECT_EQ(asked(kNeedAlphaMask, 4, 1, false), kLayeredTile);
  EXPECT_EQ(asked(kNeedAlphaMask, 4, 0, false), kLitTile) << "a still eye is served flat";
  EXPECT_EQ(asked(kNeedAlphaMask, 4, 1, true), kLitTile) << "anything quick first";
  EXPECT_EQ(asked(kNeedAlphaMask, 40, 1, false), kLitTile) << "too small to gain";
  EXPECT_EQ(asked(0, 4, 1, false), kLitTile);
  EXPECT_EQ(asked(kNeedAlphaMask, 4, 1, false, true), kLitTile) << "replaced too soon to gain";
  EXPECT_EQ(asked(kNeedAlphaMask | kNeedBlend, 4, 1, false), kLitTile);
}

// The bound of a good relief stays small; what it could not see does not.
TEST(CoreSelector, AnEyeThatGoesAroundExpectsMoreErrorThanTheBoundTells) {
  SelectorWorld world = one_ball();
  world.add_tile(0, [](TileMeasure& m) { m.depth_gap = 0; });
  double before = 0;
  for (const double angle : {0.0, 0.2, 0.6}) {
    world.look({5 * std::sin(angle), 0, 5 * std::cos(angle)}, {0, 0, 0});
    ++world.frame;
    world.select(world.input());
    const auto& considered = world.considered;
    ASSERT_EQ(considered.size(), 1u);
    const auto& tile = considered[0].deep ? considered[0].deep : considered[0].flat;
    ASSERT_TRUE(tile);
    EXPECT_GE(tile->error_px, 0.24 * angle * 50) << "a quarter of its radius a radian";
    EXPECT_GE(tile->error_px, before);
    before = tile->error_px;
  }
}

TEST(CoreSelector, NeedsAreRankedByGain) {
  SelectorWorld world(make_scene({{{-2, 0, -20}}, {{0, 0, -6}}, {{3, 0, -60}}}));
  world.look({0, 0, 0}, {0, 0, -1});
  const auto needs = world.selector.needs(world.input());
  ASSERT_EQ(needs.size(), 3u);
  EXPECT_EQ(needs[0].instance, 1u);
  EXPECT_EQ(needs[2].instance, 2u);
  EXPECT_GE(needs[0].gain, needs[1].gain);
}

TEST(CoreSelector, NewTileFadesInOverTheFormer) {
  SelectorWorld world = one_ball();
  const TileRecordPtr old_tile = world.add_tile(0);
  world.select(world.input());
  world.look({2, 0, 4}, {0, 0, 0});
  world.frame++;
  world.now_us = 1'000'000;
  const TileRecordPtr fresh = world.add_tile(0);
  for (const std::int64_t since : {0, 30'000, 60'000, 119'000}) {
    SelectorInput in = world.input();
    in.now_us = world.now_us + since;
    in.frame = ++world.frame;
    const DrawList list = world.select(in);
    ASSERT_EQ(list.impostors.size(), 2u) << since;
    EXPECT_EQ(list.impostors[0].tile, old_tile);
    EXPECT_EQ(list.impostors[0].fade, 1);
    EXPECT_EQ(list.impostors[1].tile, fresh);
    EXPECT_NEAR(list.impostors[1].fade, static_cast<double>(since) / 120'000, 1e-6);
    EXPECT_EQ(old_tile->last_drawn, in.frame) << "must not be evicted while it shows";
  }
  SelectorInput in = world.input();
  in.now_us = world.now_us + 120'000;
  const DrawList list = world.select(in);
  ASSERT_EQ(list.impostors.size(), 1u);
  EXPECT_EQ(list.impostors[0].tile, fresh);
  EXPECT_EQ(list.impostors[0].fade, 1);
}

// Two half-transparent tiles over one another cover more than each of them.
TEST(CoreSelector, SeeThroughTileIsReplacedAtOnce) {
  for (const auto& [needs, drawn] :
       {std::pair<NeedMask, std::size_t>{0, 2}, {kNeedAlphaMask, 1}, {kNeedBlend, 1}}) {
    SelectorWorld world = one_ball();
    world.scene.objects[0].triangles = 100;
    world.scene.objects[0].needs |= needs;
    world.add_tile(0);
    world.select(world.input());
    world.look({0.1, 0, 5}, {0, 0, 0});
    world.frame++;
    world.now_us = 1'000'000;
    const TileRecordPtr fresh = world.add_tile(0);
    SelectorInput in = world.input();
    in.frame = ++world.frame;
    const DrawList list = world.select(in);
    ASSERT_EQ(list.impostors.size(), drawn);
    EXPECT_EQ(list.impostors.back().tile, fresh);
  }
}

TEST(CoreSelector, EvictedFormerIsNotDrawnWhileFading) {
  SelectorWorld world = one_ball();
  const TileRecordPtr old_tile = world.add_tile(0);
  world.select(world.input());
  world.look({2, 0, 4}, {0, 0, 0});
  world.frame++;
  const TileRecordPtr fresh = world.add_tile(0);
  ASSERT_EQ(world.select(world.input()).impostors.size(), 2u);
  // The former tile goes after some frames out of view; its texels may be another tile's by now.
  world.frame += 5;
  world.cache.mark_drawn({fresh}, world.frame);
  for (int i = 0; i < 12; ++i) world.add_tile(0);
  const auto& held = world.cache.group_to_draw(0)->tiles;
  ASSERT_EQ(std::count(held.begin(), held.end(), old_tile), 0);
  world.now_us += 50'000;
  for (const DrawnImpostor& drawn : world.select(world.input()).impostors) {
    EXPECT_NE(drawn.tile, old_tile);
  }
}

TEST(CoreSelector, BackToFront) {
  SelectorWorld world(make_scene({{{-2, 0, -20}}, {{0, 0, -6}}, {{3, 0, -60}}}));
  world.look({0, 0, 0}, {0, 0, -1});
  for (std::uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(world.add_tile(i));
  const DrawList list = world.select(world.input());
  ASSERT_EQ(list.impostors.size(), 3u);
  EXPECT_GT(list.impostors[0].distance, list.impostors[1].distance);
  EXPECT_GT(list.impostors[1].distance, list.impostors[2].distance);
}

}  // namespace
}  // namespace mirage::test

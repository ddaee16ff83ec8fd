// Light that changes: which tiles are shown meanwhile, what is asked for, and how long the shown
// light has been past.
#include <gtest/gtest.h>

#include <vector>

#include "client/plan/relight_policy.h"
#include "protocol/base/limits.h"
#include "protocol/impostor/lighting_state.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

constexpr std::int64_t kMs = 1000;

Lighting sun_at(double angle, float strength = 0.8f) {
  Lighting lighting;
  lighting.ambient = glm::vec3(0.1f);
  Light sun;
  sun.color = glm::vec3(strength);
  sun.direction = glm::vec3(std::cos(angle), -0.5, std::sin(angle));
  lighting.lights.push_back(sun);
  return checked_lighting(lighting).take();
}

SceneOptions lit() {
  SceneOptions options;
  options.needs = kNeedLighting;
  return options;
}

Capture any_capture() {
  return Capture(ViewCell{4, 3, 3}, *distance_bucket_from_radii(4, 2), 1, 16);
}

Tile relit_tile(const Capture& capture) {
  Tile tile = make_tile(capture);
  tile.channels = kRelitTile;
  return tile;
}

// The sun moves every frame, and tiles are ten frames late: each is shown, and the newest light
// wins.
TEST(CoreLight, TilesOfAPastLightAreShownWhenNewerThanWhatIs) {
  const SceneView scene = make_scene({{{0, 0, 0}}}, lit());
  TileCache cache(256, 1);
  cache.reset(scene, sun_at(0));
  std::vector<std::uint32_t> asked = {cache.light()};
  for (int frame = 1; frame <= 40; ++frame) {
    cache.relight(sun_at(0.1 * frame), frame * 20 * kMs);
    asked.push_back(cache.light());
    if (frame < 10) continue;
    const std::uint32_t light = asked[static_cast<std::size_t>(frame) - 10];
    const TileRecordPtr tile = cache.insert(0, scene, any_capture(), make_tile(any_capture()),
                                            static_cast<std::uint64_t>(frame), 0, light);
    ASSERT_TRUE(tile) << frame;
    const TileCache::LitGroup shown = cache.lit_group(0);
    ASSERT_EQ(shown.tiles->tiles.back(), tile) << frame;
    EXPECT_FALSE(shown.wanted);
    ASSERT_TRUE(shown.then);
    EXPECT_EQ(shown.then->serial, light);
    EXPECT_EQ(shown.then->ended_us, (frame - 9) * 20 * kMs);
  }
  // A tile for an older light than the one shown changes nothing.
  const TileCache::LitGroup before = cache.lit_group(0);
  ASSERT_TRUE(cache.insert(0, scene, any_capture(), make_tile(any_capture()), 50, 0, asked[20]));
  EXPECT_EQ(cache.lit_group(0).tiles, before.tiles);
}

TEST(CoreLight, GroupsOfLightsLongPastAreDropped) {
  const SceneView scene = make_scene({{{0, 0, 0}}}, lit());
  TileCache cache(1024, 1);
  cache.reset(scene, sun_at(0));
  const std::uint32_t first = cache.light();
  for (int i = 1; i <= 300; ++i) {
    ASSERT_TRUE(cache.insert(0, scene, any_capture(), make_tile(any_capture()), 1, 0));
    cache.relight(sun_at(0.01 * i), i * kMs);
    ASSERT_LE(cache.groups(), limits::kMaxLightingStatesPerClient);
    ASSERT_LE(cache.lights().states().size(), limits::kMaxLightingStatesPerClient);
  }
  EXPECT_EQ(cache.resident(), limits::kMaxLightingStatesPerClient - 1);
  EXPECT_FALSE(cache.insert(0, scene, any_capture(), make_tile(any_capture()), 1, 0, first));
}

// A lamp that goes on and off has two states, each with its tiles, however often it changes.
TEST(CoreLight, AStateThatReturnsKeepsItsTiles) {
  const SceneView scene = make_scene({{{0, 0, 0}}}, lit());
  TileCache cache(256, 1);
  cache.reset(scene, sun_at(0));
  const TileRecordPtr on = cache.insert(0, scene, any_capture(), make_tile(any_capture()), 1, 0);
  cache.relight(sun_at(0, 0), kMs);
  const TileRecordPtr off = cache.insert(0, scene, any_capture(), make_tile(any_capture()), 1, 0);
  for (int i = 0; i < 200; ++i) {
    cache.relight(sun_at(0, i % 2 ? 0.0f : 0.8f), (i + 2) * kMs);
    ASSERT_TRUE(cache.lit_group(0).wanted);
    ASSERT_EQ(cache.group_to_draw(0)->tiles[0], i % 2 ? off : on);
  }
  EXPECT_EQ(cache.lights().states().size(), 2u);
}

TEST(CoreLight, RelitTilesServeEveryLightAndEveryInstance) {
  const SceneView scene = make_scene({{{0, 0, 0}}, {{9, 0, 0}}}, lit());
  TileCache cache(256, 1);
  cache.reset(scene, sun_at(0));
  const TileRecordPtr lit_tile =
      cache.insert(0, scene, any_capture(), make_tile(any_capture()), 1, 0);
  const TileRecordPtr bare = cache.insert(0, scene, any_capture(), relit_tile(any_capture()), 1, 0);
  EXPECT_EQ(cache.group_to_draw(0)->tiles[0], lit_tile) << "the server's shading is the better";
  cache.want_relit(true);
  EXPECT_EQ(cache.group_to_draw(0)->tiles[0], bare);
  EXPECT_TRUE(cache.lit_group(0).wanted);
  cache.want_relit(false);
  cache.relight(sun_at(2), kMs);
  EXPECT_EQ(cache.group_to_draw(0)->tiles[0], bare) << "right beats past";
  EXPECT_FALSE(cache.lit_group(0).wanted);
  EXPECT_FALSE(cache.lit_group(0).then) << "and lags behind nothing";
  EXPECT_EQ(cache.group_to_draw(1)->tiles[0], bare);
}

TEST(CoreLight, WhatSendsOutLightStaysLit) {
  for (const NeedMask extra : {kNeedBlend, kNeedEmissive, kNeedUnlit}) {
    SceneOptions options = lit();
    options.needs |= extra;
    const SceneView scene = make_scene({{{0, 0, 0}}}, options);
    TileCache cache(256, 1);
    cache.reset(scene, sun_at(0));
    cache.want_relit(true);
    EXPECT_FALSE(cache.wants_relit(0)) << extra;
  }
}

TEST(CoreLight, TermIsTheLargestChangeTimesTheRadius) {
  const SceneView scene = make_scene({{{0, 0, 0}}}, lit());
  const auto term = [&](const Lighting& a, const Lighting& b) {
    return light_error_px(a, b, scene.instances[0], scene.objects[0], 50);
  };
  EXPECT_EQ(term(sun_at(1), sun_at(1)), 0);
  Lighting dark, bright;
  dark.ambient = glm::vec3(0);
  bright.ambient = glm::vec3(1, 0.5f, 0);
  EXPECT_NEAR(term(dark, bright), 50, 1e-4) << "the whole range";
  bright.ambient = glm::vec3(7, 0, 0);
  EXPECT_NEAR(term(dark, bright), 50, 1e-4) << "no display shows more";
  bright.ambient = glm::vec3(0.25f);
  EXPECT_NEAR(term(bright, dark), 12.5, 1e-4);
  // A sun that turns about the vertical: the sides change, the top does not.
  Light sun;
  sun.color = glm::vec3(0.5f);
  sun.direction = {1, 0, 0};
  Lighting from_left = dark, from_right = dark;
  from_left.lights = {sun};
  sun.direction = {-1, 0, 0};
  from_right.lights = {sun};
  EXPECT_NEAR(term(from_left, from_right), 25, 1e-2);
}

TEST(CoreLight, OnlyWhatChangedVisiblyIsAskedForAgain) {
  SelectorWorld world(make_scene({{{0, 0, 0}}}, lit()));
  world.cache.reset(world.scene, sun_at(0));
  world.look({0, 0, 20}, {0, 0, 0});
  ASSERT_TRUE(world.add_tile(0));
  ASSERT_TRUE(world.selector.needs(world.input()).empty());
  world.cache.relight(sun_at(0.002), 10 * kMs);
  world.now_us = 30 * kMs;
  EXPECT_TRUE(world.selector.needs(world.input()).empty()) << "below tau";
  EXPECT_EQ(world.select(world.input()).impostors.at(0).light_lag_us, 0);
  world.cache.relight(sun_at(1), 40 * kMs);
  world.now_us = 100 * kMs;
  ++world.frame;
  const std::vector<TileNeed> needs = world.selector.needs(world.input());
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].channels, kLitTile);
  EXPECT_EQ(needs[0].light, world.cache.light());
  EXPECT_GT(needs[0].error_px, 1);
  // The tile's own light ended when the first change came.
  EXPECT_EQ(world.select(world.input()).impostors.at(0).light_lag_us, 90 * kMs);
  world.cache.want_relit(true);
  EXPECT_EQ(world.selector.needs(world.input()).at(0).channels, kRelitTile);
}

TEST(CoreRelightPolicy, FollowsASunAndIgnoresALamp) {
  RelightPolicy sun(RelightChoice::kAuto);
  sun.new_light(0);
  EXPECT_FALSE(sun.relight(0)) << "once is no habit";
  for (int frame = 1; frame <= 60; ++frame) {
    sun.new_light(frame * 33 * kMs);
    EXPECT_EQ(sun.relight(frame * 33 * kMs), frame >= 31) << frame;
  }
  EXPECT_TRUE(sun.relight(6'900 * kMs));
  EXPECT_FALSE(sun.relight(7'000 * kMs)) << "five seconds after the last";
  RelightPolicy lamp(RelightChoice::kAuto);
  lamp.new_light(1'000 * kMs);  // off; on again is known
  EXPECT_FALSE(lamp.relight(1'500 * kMs));
  lamp.new_light(9'000 * kMs);
  EXPECT_FALSE(lamp.relight(9'000 * kMs)) << "long apart";
  RelightPolicy always(RelightChoice::kAlways), never(RelightChoice::kNever);
  EXPECT_TRUE(always.relight(0));
  for (int i = 0; i < 9; ++i) never.new_light(i * 1'000 * kMs);
  EXPECT_FALSE(never.relight(9'000 * kMs));
}

}  // namespace
}  // namespace mirage::test

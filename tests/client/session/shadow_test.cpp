// Shadow stage: which shadow an impostor wears, what casts on geometry, and what is asked for.
#include <gtest/gtest.h>

#include <algorithm>

#include "client/draw/worn_shadow.h"
#include "client/hold/mesh_cache.h"
#include "client/session/shadow_stage.h"
#include "protocol/impostor/lighting_state.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

Lighting sun(const glm::vec3& direction, float strength = 0.8f) {
  Lighting lighting;
  lighting.ambient = glm::vec3(0.2f);
  Light light;
  light.color = glm::vec3(strength);
  light.direction = direction;
  lighting.lights = {light};
  return checked_lighting(lighting).take();
}

SceneOptions casting() {
  SceneOptions options;
  options.needs = kNeedLighting | kNeedShadowPass;
  return options;
}

Capture looking_along(const glm::dvec3& eye, std::uint32_t edge = 64) {
  return Capture(*view_cell_from_direction(eye, 8), *distance_bucket_from_radii(8, 1), 1, edge);
}

// A scene under a sun with its impostors drawn. It is driven through the stage as the session does.
struct ShadowWorld : SelectorWorld {
  ShadowWorld(SceneView view, const Lighting& light)
      : SelectorWorld(std::move(view)), lighting(light) {
    cache.reset(scene, lighting);
    meshes.reset(scene, 1 << 20, 1 << 20);
    now_us = 10 * kSecond;
  }
  DrawList draw() {
    ++frame;
    DrawList list = only_select(input());
    stage.shade(input(), lighting, meshes, list);
    return list;
  }
  std::vector<TileNeed> needs(std::uint8_t channels) {
    std::vector<TileNeed> all = selector.needs(input()), out;
    stage.add_needs(input(), lighting, draw(), all);
    for (const TileNeed& need : all) {
      if (need.channels == channels) out.push_back(need);
    }
    return out;
  }
  ShadowRecordPtr answer(const TileNeed& need) {
    const std::uint32_t object = scene.instances[need.instance].object;
    const Capture capture = capture_for(need, scene.objects[object].radius);
    return stage.insert(need, object, capture, {1, 1, 8, 8}, frame);
  }

  Lighting lighting;
  MeshCache meshes;
  ShadowStage stage;
};

TEST(CoreShadowCache, NearestOfTheSameLight) {
  ShadowCache cache;
  double angle = 0;
  EXPECT_FALSE(cache.shadow(0, 1, {0, 0, 1}, angle));
  const auto a = cache.add_shadow(0, 1, looking_along({0, 0, 1}), {1, 1, 8, 8}, 1);
  const auto b = cache.add_shadow(0, 1, looking_along({1, 0, 1}), {1, 1, 8, 8}, 1);
  const auto c = cache.add_shadow(0, 2, looking_along({1, 0, 0}), {1, 1, 8, 8}, 1);
  EXPECT_EQ(cache.shadow(0, 1, {0.1, 0, 1}, angle), a);
  EXPECT_NEAR(angle, 0.1, 0.03);
  EXPECT_EQ(cache.shadow(0, 1, {1, 0, 0}, angle), b) << "of another light there is a nearer one";
  EXPECT_EQ(cache.shadow(0, 2, {0, 0, 1}, angle), c);
  EXPECT_FALSE(cache.shadow(1, 1, {0, 0, 1}, angle)) << "another instance";
  EXPECT_FALSE(cache.caster(0, {0, 0, 1}, angle));
  const auto d = cache.add_caster(0, looking_along({0, 1, 0}), {1, 1, 8, 8}, 1);
  EXPECT_EQ(cache.caster(0, {0, 0, 1}, angle), d);
}

TEST(CoreShadowCache, EvictsWhatWasUsedLongestAgoAndNothingInUse) {
  ShadowCache cache;
  const TileCrop large{0, 0, 1000, 1000};
  const std::size_t room = kShadowAtlasLayers;
  std::vector<ShadowRecordPtr> all;
  for (std::uint32_t i = 0; i < room; ++i) {
    all.push_back(cache.add_shadow(i, 1, looking_along({0, 0, 1}, 512), large, i));
    ASSERT_TRUE(all.back()) << i;
  }
  EXPECT_EQ(cache.resident(), room);
  all[0]->last_used = 200;
  ASSERT_TRUE(cache.add_caster(7, looking_along({0, 0, 1}, 512), large, 201));
  double angle = 0;
  EXPECT_TRUE(cache.shadow(0, 1, {0, 0, 1}, angle));
  EXPECT_FALSE(cache.shadow(1, 1, {0, 0, 1}, angle)) << "the oldest but one had to go";
  for (const ShadowRecordPtr& record : all) record->last_used = 300;
  cache.add_caster(7, looking_along({0, 1, 0}, 512), large, 300);  // replaces the one of frame 201
  EXPECT_FALSE(cache.add_caster(8, looking_along({0, 0, 1}, 512), large, 301));
  EXPECT_EQ(cache.resident(), room);
  cache.reset();
  EXPECT_EQ(cache.resident(), 0u);
}

TEST(CoreShadowStage, WithoutASunNothingIsCastAndNothingAskedFor) {
  Lighting lamp;
  lamp.lights.resize(1);
  lamp.lights[0].kind = LightKind::kPoint;
  ShadowWorld world(make_scene({{{0, 0, 0}}}, casting()), lamp);
  world.look({0, 0, 20}, {0, 0, 0});
  ASSERT_TRUE(world.add_tile(0));
  EXPECT_FALSE(world.draw().casters);
  EXPECT_TRUE(world.needs(kShadowTile).empty());
  EXPECT_TRUE(world.needs(kCasterTile).empty());
}

TEST(CoreShadowStage, AShadowIsAskedForWhereItShowsAndWornWhileItsLightLasts) {
  ShadowWorld world(make_scene({{{0, 0, 0}}, {{0, 0, -9000}}}, casting()), sun({0, -1, 0}));
  world.look({0, 0, 20}, {0, 0, 0});
  EXPECT_TRUE(world.needs(kShadowTile).empty()) << "no picture yet to wear it";
  const TileRecordPtr tile = world.add_tile(0);
  const std::vector<TileNeed> needs = world.needs(kShadowTile);
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].instance, 0u);
  EXPECT_LE(tile_edge(needs[0].size_class), tile->capture.edge / 2 + 1) << "half the edge";
  EXPECT_FALSE(world.draw().impostors.at(0).shadow);
  const ShadowRecordPtr shadow = world.answer(needs[0]);
  EXPECT_EQ(world.draw().impostors.at(0).shadow, shadow);
  EXPECT_TRUE(world.needs(kShadowTile).empty());
  // One tile serves from a little aside. From far aside it is worn until a better one arrives.
  world.look({1, 0, 20}, {0, 0, 0});
  EXPECT_TRUE(world.needs(kShadowTile).empty());
  world.look({9, 0, 17}, {0, 0, 0});
  EXPECT_EQ(world.needs(kShadowTile).size(), 1u);
  EXPECT_EQ(world.draw().impostors.at(0).shadow, shadow);
  // Another light never uses the old shadow, and asks for a new one only once the sun rests.
  const Lighting before = world.lighting;
  world.lighting = sun({1, -1, 0});
  world.cache.relight(world.lighting, world.now_us);
  world.stage.relight(world.now_us);
  EXPECT_FALSE(world.draw().impostors.at(0).shadow);
  EXPECT_TRUE(world.needs(kShadowTile).empty());
  world.now_us += kSecond;
  EXPECT_EQ(world.needs(kShadowTile).size(), 1u);
  world.cache.relight(before, world.now_us);
  world.lighting = before;
  EXPECT_EQ(world.draw().impostors.at(0).shadow, shadow) << "back again, and still here";
}

TEST(CoreShadowStage, AShadowAsFineAsTilesGetIsNotAskedForAgain) {
  ShadowWorld world(make_scene({{{0, 0, 0}}}, casting()), sun({0, -1, 0}));
  world.camera.height = 4000;  // a finer picture than tiles can be
  world.look({0, 0, 2}, {0, 0, 0});
  ASSERT_TRUE(world.add_tile(0));
  const std::vector<TileNeed> needs = world.needs(kShadowTile);
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].size_class, kMaxAskedSizeClass - 2) << "the finest";
  ASSERT_TRUE(world.answer(needs[0]));
  EXPECT_TRUE(world.needs(kShadowTile).empty()) << "coarse, but nothing finer would come";
}

TEST(CoreShadowStage, AFaintSunIsNotWorthATile) {
  ShadowWorld world(make_scene({{{0, 0, 0}}}, casting()), sun({0, -1, 0}, 0.01f));
  world.look({0, 0, 20}, {0, 0, 0});
  ASSERT_TRUE(world.add_tile(0));
  EXPECT_TRUE(world.needs(kShadowTile).empty());
}

TEST(CoreShadowStage, CastersComeFromTilesAlongTheLightAndChangeOnlyWithTheirContent) {
  ShadowWorld world(make_scene({{{0, 0, 0}}, {{8, 0, 0}}, {{0, 0, 40}}}, casting()),
                    sun({0, -1, 0}));
  world.look({0, 0, 20}, {0, 0, 0});
  const CasterListPtr none = world.draw().casters;
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->tiles.empty());
  const std::vector<TileNeed> needs = world.needs(kCasterTile);
  ASSERT_EQ(needs.size(), 1u) << "one object, one direction: one tile for all three";
  const glm::dvec3 from = direction_from_view_cell(needs[0].cell);
  EXPECT_GT(from.y, 0.98) << "as the sun sees it";
  ASSERT_TRUE(world.answer(needs[0]));
  EXPECT_EQ(world.draw().casters, none) << "not every frame";
  EXPECT_TRUE(world.needs(kCasterTile).empty()) << "not again what has come since";
  world.now_us += kSecond;
  const CasterListPtr all = world.draw().casters;
  EXPECT_EQ(all->tiles.size(), 3u) << "also the one behind the eye";
  EXPECT_TRUE(world.needs(kCasterTile).empty());
  world.now_us += kSecond;
  world.look({0.5, 0, 20}, {0, 0, 0});
  EXPECT_EQ(world.draw().casters, all) << "nothing has changed: the same map";
  world.stage.assets_changed();
  world.now_us += kSecond;
  EXPECT_NE(world.draw().casters, all);
  const CasterListPtr before = world.draw().casters;
  world.lighting = sun({1, -1, 0});
  EXPECT_NE(world.draw().casters, before) << "a sun that has turned at once";
}

TEST(CoreShadowStage, WhatDoesNotCastIsLeftOut) {
  const auto asked = [](const SceneOptions& options) {
    ShadowWorld world(make_scene({{{0, 0, 0}}}, options), sun({0, -1, 0}));
    world.look({0, 0, 20}, {0, 0, 0});
    return world.needs(kCasterTile).size();
  };
  EXPECT_EQ(asked(casting()), 1u);
  SceneOptions blended = casting();
  blended.needs = kNeedLighting | kNeedBlend;
  EXPECT_EQ(asked(blended), 0u);
}

// A point is read from the texel in which the capture saw it.
TEST(CoreWornShadow, FindsTheTexelOfAPoint) {
  auto record = std::make_shared<ShadowRecord>();
  record->capture = looking_along({0.3, 0.5, -0.8}, 90);
  record->crop = {7, 11, 60, 50};
  record->slot = {2, 100, 200, 62, 52};
  DrawnImpostor drawn;
  EXPECT_LT(worn_shadow(drawn).place.w, 0) << "none";
  drawn.shadow = record;
  const glm::quat space = glm::angleAxis(1.1f, glm::normalize(glm::vec3(1, 2, -1)));
  for (const glm::dvec3 point : {glm::dvec3(0), {0.4, -0.2, 0.3}, {-0.5, 0.5, 0.1}}) {
    const WornShadow worn = worn_shadow(drawn, space);
    const glm::quat turn(worn.rotation.w, worn.rotation.x, worn.rotation.y, worn.rotation.z);
    const glm::vec3 p = glm::conjugate(turn) * (space * glm::vec3(point));
    const glm::vec2 texel = glm::vec2(worn.view.z, worn.view.w) +
                            glm::vec2(p.x, -p.y) * (worn.view.y / (worn.view.x - p.z));
    const glm::dvec2 in_tile = record->capture.texel_from_point(point);
    EXPECT_NEAR(texel.x, in_tile.x - 7 + 101, 1e-3);
    EXPECT_NEAR(texel.y, in_tile.y - 11 + 201, 1e-3);
    EXPECT_EQ(worn.place.w, 2);
    EXPECT_EQ(worn.place.z, 60 + 4096 * 50);
  }
}

TEST(CoreWornShadow, TintIsTheSunsShareOfEachColour) {
  EXPECT_NEAR(glm::length(shadow_tint(sun({0, -1, 0})) - glm::vec3(1)), 0, 1e-6) << "grey light";
  Lighting warm = sun({0, -1, 0});
  warm.ambient = {0.1f, 0.2f, 0.4f};
  const glm::vec3 tint = shadow_tint(warm);
  EXPECT_GT(tint.r, 1);
  EXPECT_LT(tint.b, 1) << "blue is what the sky leaves";
}

}  // namespace
}  // namespace mirage::test

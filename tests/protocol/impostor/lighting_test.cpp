// Lighting states and tile keys: equal light, equal key.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "protocol/base/limits.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/tile_key.h"

namespace mirage::test {
namespace {

constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kFloatInf = std::numeric_limits<float>::infinity();

Lighting some_lights() {
  Lighting lighting;
  lighting.ambient = {0.1f, 0.2f, 0.3f};
  Light sun;
  sun.color = {2, 1.9f, 1.5f};
  sun.direction = {0.48f, -0.64f, 0.6f};
  Light lamp;
  lamp.kind = LightKind::kPoint;
  lamp.color = {10, 5, 1};
  lamp.position = {1, 2, 3};
  lamp.range = 20;
  Light spot;
  spot.kind = LightKind::kSpot;
  spot.color = {3, 3, 3};
  spot.position = {-2, 1, 0.5};
  spot.direction = {0.8f, -0.48f, 0.36f};  // a cone that misses is no light at all
  spot.cos_inner = 0.9f;
  spot.cos_outer = 0.7f;
  lighting.lights = {sun, lamp, spot};
  return lighting;
}

std::uint64_t hash_of(const Lighting& lighting, const Similarity& m = {}) {
  return object_lighting(lighting, m, glm::vec3(0), 1).hash();
}

TEST(ProtocolLighting, OrderDoesNotMatter) {
  Lighting lighting = some_lights();
  const std::uint64_t expected = hash_of(lighting);
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    std::shuffle(lighting.lights.begin(), lighting.lights.end(), random);
    EXPECT_EQ(hash_of(lighting), expected);
  }
}

TEST(ProtocolLighting, EveryValueCounts) {
  const std::uint64_t expected = hash_of(some_lights());
  std::set<std::uint64_t> seen = {expected};
  const auto differs = [&](const auto& change) {
    Lighting lighting = some_lights();
    change(lighting);
    EXPECT_TRUE(seen.insert(hash_of(lighting)).second);
  };
  for (int i = 0; i < 3; ++i) {
    differs([i](Lighting& l) { l.ambient[i] += 0.01f; });
    differs([i](Lighting& l) { l.lights[1].color[i] += 0.01f; });
    differs([i](Lighting& l) { l.lights[1].position[i] += 0.1; });
    differs([i](Lighting& l) { l.lights[2].direction[i] += 0.1f; });
  }
  differs([](Lighting& l) { l.lights[1].range = 30; });
  differs([](Lighting& l) { l.lights[2].cos_inner = 0.95f; });
  differs([](Lighting& l) { l.lights[2].cos_outer = 0.6f; });
  differs([](Lighting& l) { l.lights[2].kind = LightKind::kPoint; });
  differs([](Lighting& l) { l.lights.pop_back(); });
}

TEST(ProtocolLighting, MinusZeroIsZero) {
  Lighting plus = some_lights();
  plus.ambient.g = 0;
  plus.lights[0].direction = {0, -1, 0};
  plus.lights[1].position.x = 0;
  Lighting minus = plus;
  minus.ambient.g = -0.0f;
  minus.lights[0].direction = {-0.0f, -1, -0.0f};
  minus.lights[1].position.x = -0.0;
  EXPECT_EQ(hash_of(plus), hash_of(minus));
}

TEST(ProtocolLighting, MinusZeroInColorsAndAngles) {
  Lighting plus = some_lights();
  plus.lights[1].color.g = 0;
  plus.lights[0].color.b = 0;
  plus.lights[1].range = 0;
  plus.lights[2].cos_outer = 0;
  Lighting minus = plus;
  minus.lights[1].color.g = -0.0f;
  minus.lights[0].color.b = -0.0f;
  minus.lights[1].range = -0.0f;
  minus.lights[2].cos_outer = -0.0f;
  EXPECT_EQ(hash_of(plus), hash_of(minus));
}

TEST(ProtocolLighting, WhatAddsNothingIsLeftOut) {
  const std::uint64_t expected = hash_of(some_lights());
  Lighting lighting = some_lights();
  Light black;
  black.color = glm::vec3(0);
  lighting.lights.push_back(black);
  black.kind = LightKind::kPoint;
  lighting.lights.insert(lighting.lights.begin(), black);
  EXPECT_EQ(hash_of(lighting), expected);
  Light far_away;
  far_away.kind = LightKind::kPoint;
  far_away.position = {50, 0, 0};
  far_away.range = 48.9f;  // the sphere of radius 1 begins at 49
  lighting.lights.push_back(far_away);
  EXPECT_EQ(hash_of(lighting), expected);
  lighting.lights.back().range = 49.1f;
  EXPECT_NE(hash_of(lighting), expected);
  lighting.lights.back().range = 0;  // unlimited
  EXPECT_NE(hash_of(lighting), expected);
}

TEST(ProtocolLighting, RangeIsInObjectUnits) {
  Lighting lighting;
  Light lamp;
  lamp.kind = LightKind::kPoint;
  lamp.position = {30, 0, 0};
  lamp.range = 19;
  lighting.lights = {lamp};
  Similarity m;
  m.scale = 10;  // the sphere reaches to 10 m, the light to 11 m from the origin
  EXPECT_TRUE(object_lighting(lighting, m, glm::vec3(0), 1).lights.empty());
  lighting.lights[0].range = 21;
  const ObjectLighting seen = object_lighting(lighting, m, glm::vec3(0), 1);
  ASSERT_EQ(seen.lights.size(), 1u);
  EXPECT_FLOAT_EQ(seen.lights[0].position.x, 3);
  EXPECT_FLOAT_EQ(seen.lights[0].range, 2.1f);
  EXPECT_FLOAT_EQ(seen.lights[0].color.r, 0.01f);
}

TEST(ProtocolLighting, TurnsWithTheObject) {
  Lighting lighting;
  lighting.lights.resize(1);
  lighting.lights[0].direction = {0, -1, 0};
  Similarity m;
  m.rotation = glm::angleAxis(1.57079632679f, glm::vec3(0, 0, 1));  // object y is world -x
  const ObjectLighting seen = object_lighting(lighting, m, glm::vec3(0), 1);
  EXPECT_LT(glm::length(seen.lights[0].direction - glm::vec3(-1, 0, 0)), 1e-3f);
}

TEST(ProtocolLighting, SmallMotionsKeepTheKey) {
  Lighting lighting = some_lights();
  const std::uint64_t expected = hash_of(lighting);
  lighting.lights[1].position.x += 1.0 / 256 / 4;
  EXPECT_EQ(hash_of(lighting), expected);
}

void expect_refused(const Lighting& lighting) {
  const Result<Lighting> checked = checked_lighting(lighting);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().id, ErrorId::kWireValue);
}

TEST(ProtocolLighting, BadValuesAreRefused) {
  ASSERT_TRUE(checked_lighting(some_lights()));
  for (const float bad : {kFloatNan, kFloatInf, -kFloatInf, -1.0f}) {
    for (int i = 0; i < 3; ++i) {
      Lighting lighting = some_lights();
      lighting.ambient[i] = bad;
      expect_refused(lighting);
      lighting = some_lights();
      lighting.lights[0].color[i] = bad;
      expect_refused(lighting);
      if (bad == -1.0f) continue;
      lighting = some_lights();
      lighting.lights[1].position[i] = static_cast<double>(bad);
      expect_refused(lighting);
      lighting = some_lights();
      lighting.lights[2].direction[i] = bad;
      expect_refused(lighting);
    }
    Lighting lighting = some_lights();
    lighting.lights[1].range = bad;
    expect_refused(lighting);
    if (bad == -1.0f) continue;
    lighting = some_lights();
    lighting.lights[2].cos_inner = bad;
    expect_refused(lighting);
    lighting = some_lights();
    lighting.lights[2].cos_outer = bad;
    expect_refused(lighting);
  }
  Lighting lighting = some_lights();
  lighting.lights[0].direction = glm::vec3(0);
  expect_refused(lighting);
}

TEST(ProtocolLighting, TooManyLightsAreRefused) {
  Lighting lighting;
  lighting.lights.resize(limits::kMaxLights);
  EXPECT_TRUE(checked_lighting(lighting));
  lighting.lights.resize(limits::kMaxLights + 1);
  expect_refused(lighting);
}

TEST(ProtocolLighting, DirectionsAreMadeUnit) {
  Lighting lighting = some_lights();
  lighting.lights[0].direction = {0, -1e-30f, 0};
  EXPECT_EQ(checked_lighting(lighting)->lights[0].direction, glm::vec3(0, -1, 0));
}

TileKey some_key() {
  TileKey key;
  key.scene_revision = 0x0123456789abcdef;
  key.object = 77;
  key.cell = {9, 300, 17};
  key.distance = {4, -3};
  key.size_class = 6;
  key.lighting = 0xfedcba9876543210;
  key.phase = 5;
  return key;
}

TEST(ProtocolTileKey, EveryFieldCounts) {
  std::set<std::pair<std::uint64_t, std::uint64_t>> seen;
  const auto add = [&](const auto& change) {
    TileKey key = some_key();
    change(key);
    const TileId id = tile_id(key);
    EXPECT_TRUE(seen.insert({id.low, id.high}).second);
  };
  add([](TileKey&) {});
  add([](TileKey& k) { ++k.scene_revision; });
  add([](TileKey& k) { k.scene_revision ^= 1ull << 63; });
  add([](TileKey& k) { ++k.object; });
  add([](TileKey& k) { ++k.cell.level; });
  add([](TileKey& k) { ++k.cell.x; });
  add([](TileKey& k) { ++k.cell.y; });
  add([](TileKey& k) { std::swap(k.cell.x, k.cell.y); });
  add([](TileKey& k) { ++k.distance.level; });
  add([](TileKey& k) { ++k.distance.index; });
  add([](TileKey& k) { k.distance.index = 3; });
  add([](TileKey& k) { ++k.size_class; });
  add([](TileKey& k) { ++k.lighting; });
  add([](TileKey& k) { ++k.phase; });
  add([](TileKey& k) { k.channels ^= kChannelNormal; });
  EXPECT_TRUE(tile_id(some_key()) == tile_id(some_key()));
}

// Wire and store carry this value, so it may change only with the protocol version.
TEST(ProtocolTileKey, GoldenValue) {
  EXPECT_EQ(tile_id(some_key()).low, 10587653953638276656u);
  EXPECT_EQ(tile_id(some_key()).high, 7117905157872389931u);
}

TEST(ProtocolTileKey, SizeClasses) {
  EXPECT_EQ(tile_edge(0), 16u);
  EXPECT_EQ(tile_edge(1), 23u);
  EXPECT_EQ(tile_edge(2), 32u);
  EXPECT_EQ(tile_edge(limits::kMaxSizeClass), limits::kMaxTileEdge);
  for (int c = 0; c <= limits::kMaxSizeClass; ++c) {
    EXPECT_EQ(size_class_for(tile_edge(c)), c);
    EXPECT_EQ(size_class_for(tile_edge(c) + 0.5), std::min(c + 1, limits::kMaxSizeClass));
  }
  EXPECT_EQ(size_class_for(0), 0);
  EXPECT_EQ(size_class_for(1e9), limits::kMaxSizeClass);
}

}  // namespace
}  // namespace mirage::test

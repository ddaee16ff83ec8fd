// The sun's view of a scene, and the tiles that carry shadows.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/sun_frame.h"
#include "protocol/impostor/tile_key.h"

namespace mirage::test {
namespace {

Light directional(const glm::vec3& color, const glm::vec3& direction) {
  Light light;
  light.color = color;
  light.direction = glm::normalize(direction);
  return light;
}

TEST(ProtocolSun, IsTheStrongestDirectionalLight) {
  Lighting lighting;
  EXPECT_EQ(sun_of(lighting), nullptr);
  Light lamp;
  lamp.kind = LightKind::kPoint;
  lamp.color = glm::vec3(100);
  lighting.lights = {lamp, directional(glm::vec3(0), {0, -1, 0})};
  EXPECT_EQ(sun_of(lighting), nullptr) << "a black one is none";
  lighting.lights.push_back(directional({0, 0, 2}, {0, -1, 0}));
  lighting.lights.push_back(directional({0, 1, 0}, {1, -1, 0}));
  lighting.lights.push_back(directional({0, 1, 0}, {0, -1, 1}));
  EXPECT_EQ(sun_of(lighting), &lighting.lights[3]) << "green is brighter, and the first of equals";
}

TEST(ProtocolSun, FrameHoldsTheSphereAndDepthGrowsAlongTheLight) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const glm::dvec3 center(3e5, -20, 7), eye(3e5 + 12, -18, 9);
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 direction = i == 0   ? glm::vec3(0, -1, 0)
                                : i == 1 ? glm::vec3(0, 0, 1)
                                : i == 2
                                    ? glm::vec3(0, 0, -1)
                                    : glm::vec3(normal(random), normal(random), normal(random));
    const SunFrame frame(direction, center, 40, 1024);
    ASSERT_NEAR(glm::length(frame.right), 1, 1e-12);
    ASSERT_NEAR(glm::dot(frame.right, frame.up), 0, 1e-12);
    ASSERT_NEAR(glm::length(glm::cross(frame.right, frame.up) + frame.forward), 0, 1e-12);
    const glm::dvec3 off =
        39.9 * glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const auto at = [&](const glm::dvec3& world, const glm::dvec3& from) {
      return glm::vec3(frame.map_from_relative(from) * glm::vec4(glm::vec3(world - from), 1));
    };
    const glm::vec3 seen = at(center + off, eye);
    for (int c = 0; c < 3; ++c) ASSERT_TRUE(seen[c] > 0 && seen[c] < 1);
    ASSERT_LT(glm::length(seen - at(center + off, center)), 1e-5) << "whatever it is relative to";
    const glm::vec3 farther = at(center + 0.5 * off + frame.forward, eye);
    const glm::vec3 nearer = at(center + 0.5 * off, eye);
    ASSERT_NEAR(farther.z - nearer.z, 1.0 / 80, 1e-5);
    ASSERT_NEAR(farther.x, nearer.x, 1e-5);
  }
  EXPECT_DOUBLE_EQ(SunFrame({0, -1, 0}, center, 40, 1024).texel_m(), 80.0 / 1024);
}

TEST(ProtocolShadowKey, HoldsPlaceAndLight) {
  TileKey key;
  key.channels = kShadowTile;
  key.instance = 1;
  TileKey other = key;
  other.instance = 2;
  EXPECT_FALSE(tile_id(key) == tile_id(other));
  Lighting lighting;
  lighting.lights = {directional(glm::vec3(1), {1, -2, 0})};
  const std::uint64_t hash = lighting_hash(lighting);
  Lighting same = lighting;
  same.lights.push_back(directional(glm::vec3(0), {0, -1, 0}));
  same.lights[0].direction.z = -0.0f;
  EXPECT_EQ(lighting_hash(same), hash) << "black lights and the sign of zero are neutral";
  Lighting turned = lighting;
  turned.lights[0].direction = glm::normalize(glm::vec3(1, -2, 1e-4));
  EXPECT_NE(lighting_hash(turned), hash);
  Lighting brighter = lighting;
  brighter.ambient.g += 0.01f;
  EXPECT_NE(lighting_hash(brighter), hash);
}

TEST(ProtocolShadowTile, OnePlaneThereAndBack) {
  for (const std::uint8_t channels : {kShadowTile, kCasterTile}) {
    Tile tile;
    tile.edge = 64;
    tile.crop = {3, 4, 21, 17};
    tile.channels = channels;
    std::vector<std::uint8_t>& plane = channels == kShadowTile ? tile.shadow : tile.depth;
    for (std::size_t i = 0; i < tile.crop.area(); ++i) {
      plane.push_back(static_cast<std::uint8_t>(i % 251));
    }
    for (const TileCodec codec : {TileCodec::kRaw, TileCodec::kZstd}) {
      const std::vector<std::uint8_t> bytes = encode_tile_planes(tile, codec);
      EXPECT_LE(bytes.size(), tile.crop.area());
      Tile back;
      back.edge = tile.edge;
      back.crop = tile.crop;
      back.channels = channels;
      ASSERT_TRUE(decode_tile_planes(bytes.data(), bytes.size(), codec, back));
      EXPECT_EQ(back.shadow, tile.shadow);
      EXPECT_EQ(back.depth, tile.depth);
      EXPECT_TRUE(back.rgba.empty());
      EXPECT_EQ(tile_content_hash(back), tile_content_hash(tile));
      back.channels = kLitTile;
      EXPECT_FALSE(decode_tile_planes(bytes.data(), bytes.size(), codec, back));
    }
    Tile changed = tile;
    (channels == kShadowTile ? changed.shadow : changed.depth)[5] ^= 1;
    EXPECT_NE(tile_content_hash(changed), tile_content_hash(tile));
  }
}

}  // namespace
}  // namespace mirage::test

// Tile cache: a tile on the screen is never evicted, and an evicted one leaves nothing behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

// 16 texels with the gutter: a 64-texel layer takes sixteen of them.
constexpr int kAtlasEdge = 64;
constexpr std::size_t kFull = 16;

Capture small_capture(int n) {
  const ViewCell cell{4, static_cast<std::uint16_t>(n % 16), static_cast<std::uint16_t>(n / 16)};
  return Capture(cell, *distance_bucket_from_radii(4, 2), 1, 16);
}

SceneView four_objects() {
  std::vector<Placed> placed;
  for (std::uint32_t i = 0; i < 4; ++i) placed.push_back({{i * 3.0, 0, 0}, 1, i});
  return make_scene(placed, {4});
}

TEST(CoreTileCache, FullAtlasNeverEvictsWhatIsOnScreen) {
  const SceneView scene = four_objects();
  TileCache cache(kAtlasEdge, 1);
  cache.reset(scene, scene.lighting);
  std::vector<TileRecordPtr> records;
  for (int n = 0; n < static_cast<int>(kFull); ++n) {
    const Capture capture = small_capture(n);
    const auto instance = static_cast<std::uint32_t>(n % 4);
    records.push_back(cache.insert(instance, scene, capture, make_tile(capture), 5, 0));
    ASSERT_TRUE(records.back()) << n;
  }
  const Capture late = small_capture(100);
  EXPECT_FALSE(cache.insert(0, scene, late, make_tile(late), 5, 0));
  EXPECT_FALSE(cache.insert(0, scene, late, make_tile(late), 6, 0)) << "drawn a frame ago";
  EXPECT_EQ(cache.resident(), kFull);
  // All tiles but one are drawn again; that one makes room.
  cache.mark_drawn(records, 9);
  cache.mark_drawn({records[7]}, 8);
  const TileRecordPtr placed = cache.insert(0, scene, late, make_tile(late), 10, 0);
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->slot.x, records[7]->slot.x);
  EXPECT_EQ(placed->slot.y, records[7]->slot.y);
  const std::vector<TileRecordPtr>& held = cache.group_to_draw(3)->tiles;
  EXPECT_EQ(std::count(held.begin(), held.end(), records[7]), 0);
  EXPECT_EQ(cache.resident(), kFull);
}

Tile layered_tile(const Capture& capture, std::uint8_t code_behind) {
  Tile tile = make_tile(capture);
  tile.channels = kLayeredTile;
  tile.behind_depth.assign(tile.crop.area(), code_behind);
  return tile;
}

TEST(CoreTileCache, LayersTakePlacesOfTheirOwnAndGiveThemBack) {
  const SceneView scene = four_objects();
  TileCache cache(kAtlasEdge, 1);
  cache.reset(scene, scene.lighting);
  for (int n = 0; n < 64; ++n) {  // many times more than there is room for
    const Capture capture = small_capture(n);
    const TileRecordPtr tile =
        cache.insert(0, scene, capture, layered_tile(capture, 9), 10 * static_cast<unsigned>(n), 0);
    ASSERT_TRUE(tile && tile->layered()) << n;
    const auto place = [](const AtlasSlot& s) { return std::pair(s.x, s.y); };
    EXPECT_NE(place(tile->slot), place(tile->front_slot));
    EXPECT_NE(place(tile->slot), place(tile->behind_slot));
    EXPECT_NE(place(tile->front_slot), place(tile->behind_slot));
  }
  EXPECT_LE(cache.resident(), kFull / 3);
}

TEST(CoreTileCache, WithoutRoomForItsLayersOrWithNothingBehindATileIsALitOne) {
  const SceneView scene = four_objects();
  TileCache cache(kAtlasEdge, 1);
  cache.reset(scene, scene.lighting);
  const Capture bare = small_capture(90);
  const TileRecordPtr nothing = cache.insert(0, scene, bare, layered_tile(bare, 0), 5, 0);
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(nothing->layered());
  for (int n = 0; n < static_cast<int>(kFull) - 3; ++n) {
    const Capture capture = small_capture(n);
    ASSERT_TRUE(cache.insert(static_cast<std::uint32_t>(n % 3) + 1, scene, capture,
                             make_tile(capture), 5, 0));
  }
  const Capture late = small_capture(100), later = small_capture(101);
  const TileRecordPtr tile = cache.insert(0, scene, late, layered_tile(late, 9), 5, 0);
  ASSERT_TRUE(tile) << "there are two places left";
  EXPECT_FALSE(tile->layered());
  EXPECT_TRUE(cache.insert(0, scene, later, make_tile(later), 5, 0)) << "the other is free again";
}

TEST(CoreTileCache, WhatWasDrawnLongestAgoGoesFirst) {
  const SceneView scene = four_objects();
  TileCache cache(kAtlasEdge, 1);
  cache.reset(scene, scene.lighting);
  std::vector<TileRecordPtr> held;
  std::uint32_t random = 1;
  int evicted = 0, next = 0;
  for (std::uint64_t frame = 10; frame < 400; ++frame) {
    for (const TileRecordPtr& tile : held) {
      random = random * 1664525u + 1013904223u;
      if (random >> 30 == 0) cache.mark_drawn({tile}, frame);
    }
    for (int k = 0; k < 2; ++k) {
      const Capture capture = small_capture(next++ % 256);
      const auto instance = static_cast<std::uint32_t>(next % 4);
      // The next to be evicted is the tile out of view that was drawn longest ago; of equally old
      // ones the earliest.
      const auto oldest =
          std::min_element(held.begin(), held.end(), [](const auto& a, const auto& b) {
            return std::tie(a->last_drawn, a->serial) < std::tie(b->last_drawn, b->serial);
          });
      const bool full = held.size() == kFull;
      const bool room = !full || (*oldest)->last_drawn + 1 < frame;
      const TileRecordPtr placed =
          cache.insert(instance, scene, capture, make_tile(capture), frame, 0);
      ASSERT_EQ(placed != nullptr, room) << frame;
      if (!placed) continue;
      if (full) {
        ASSERT_EQ(placed->slot.x, (*oldest)->slot.x) << frame;
        ASSERT_EQ(placed->slot.y, (*oldest)->slot.y) << frame;
        held.erase(oldest);
        ++evicted;
      }
      held.push_back(placed);
    }
  }
  EXPECT_GT(evicted, 100);
}

TEST(CoreTileCache, TileLargerThanTheAtlasIsLeftOut) {
  const SceneView scene = four_objects();
  TileCache cache(kAtlasEdge, 1);
  cache.reset(scene, scene.lighting);
  const Capture small = small_capture(0);
  ASSERT_TRUE(cache.insert(0, scene, small, make_tile(small), 1, 0));
  const Capture large(ViewCell{}, *distance_bucket_from_radii(4, 2), 1, 128);
  EXPECT_FALSE(cache.insert(0, scene, large, make_tile(large), 100, 0));
  EXPECT_EQ(cache.resident(), 1u) << "nothing is evicted for what can never fit";
}

TEST(CoreTileCache, EmptyTileTakesNoRoom) {
  const SceneView scene = four_objects();
  TileCache cache(kAtlasEdge, 1);
  cache.reset(scene, scene.lighting);
  const Capture capture = small_capture(0);
  Tile tile = make_tile(capture);
  tile.crop = {};
  EXPECT_FALSE(cache.insert(2, scene, capture, std::move(tile), 1, 0));
  // Empty from there, but only from there: a sheet seen from behind shows from the front.
  EXPECT_TRUE(cache.group_to_draw(2)->empty_from(capture.eye()));
  const Capture fine(*view_cell_from_direction({0, 0, 1}, 8), *distance_bucket_from_radii(4, 2), 1,
                     64);
  EXPECT_FALSE(cache.insert(3, scene, fine, Tile{}, 1, 0));
  EXPECT_TRUE(cache.group_to_draw(3)->empty_from(fine.eye()));
  EXPECT_FALSE(cache.group_to_draw(3)->empty_from(-fine.eye()));
  EXPECT_EQ(cache.atlas_texels(), 0u);
}

TEST(CoreTileCache, TheSameTileAgainAndAgainDoesNotLeak) {
  const SceneView scene = four_objects();
  TileCache cache(256, 1);
  cache.reset(scene, scene.lighting);
  const Capture capture = small_capture(0);
  for (std::uint64_t frame = 1; frame <= 1000; ++frame) {
    ASSERT_TRUE(cache.insert(0, scene, capture, make_tile(capture), frame, 0));
    ASSERT_LE(cache.resident(), 9u);
    ASSERT_EQ(cache.atlas_texels(), cache.resident() * 256);
  }
  cache.reset(scene, scene.lighting);
  EXPECT_EQ(cache.resident(), 0u);
  EXPECT_EQ(cache.atlas_texels(), 0u);
}

TEST(CoreTileCache, InstancesOfOneObjectShareTheirTiles) {
  const SceneView scene = make_scene({{{0, 0, 0}}, {{5, 0, 0}}});
  TileCache cache(256, 1);
  cache.reset(scene, scene.lighting);
  const Capture capture = small_capture(0);
  ASSERT_TRUE(cache.insert(0, scene, capture, make_tile(capture), 1, 0));
  EXPECT_EQ(cache.group_to_draw(0), cache.group_to_draw(1));
}

TEST(CoreTileCache, NewLightShowsOldTilesUntilNewOnesCome) {
  SceneOptions options;
  options.needs = kNeedLighting;
  const SceneView scene = make_scene({{{0, 0, 0}}}, options);
  TileCache cache(256, 1);
  Lighting lighting = scene.lighting;
  cache.reset(scene, lighting);
  const Capture capture = small_capture(0);
  const TileRecordPtr old_tile = cache.insert(0, scene, capture, make_tile(capture), 1, 0);
  ASSERT_TRUE(cache.lit_group(0).wanted);
  for (int i = 1; i <= 3; ++i) {  // lights that change faster than tiles arrive
    lighting.ambient = glm::vec3(0.1f * static_cast<float>(i));
    cache.relight(lighting, 1000 * i);
    ASSERT_EQ(cache.group_to_draw(0)->tiles.size(), 1u);
    EXPECT_EQ(cache.group_to_draw(0)->tiles[0], old_tile);
    EXPECT_FALSE(cache.lit_group(0).wanted);
  }
  const TileRecordPtr fresh = cache.insert(0, scene, capture, make_tile(capture), 2, 0);
  EXPECT_TRUE(cache.lit_group(0).wanted);
  ASSERT_EQ(cache.group_to_draw(0)->tiles.size(), 1u);
  EXPECT_EQ(cache.group_to_draw(0)->tiles[0], fresh);
  // The former light returns: its tile is still there.
  cache.relight(scene.lighting, 5000);
  EXPECT_TRUE(cache.lit_group(0).wanted);
  EXPECT_EQ(cache.group_to_draw(0)->tiles[0], old_tile);
}

}  // namespace
}  // namespace mirage::test

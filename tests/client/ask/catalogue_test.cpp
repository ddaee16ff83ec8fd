// Catalogue: needs of a client of a frozen folder become the nearest files that it has.
#include "client/ask/catalogue.h"

#include <gtest/gtest.h>

#include "client/hold/mesh_cache.h"
#include "protocol/base/limits.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

wire::FrozenTile frozen(const TileNeed& need, std::uint32_t instance, std::uint32_t bytes = 100) {
  return {1,
          bytes,
          instance,
          0,
          need.distance.index,
          need.cell.x,
          need.cell.y,
          need.phase,
          need.cell.level,
          need.distance.level,
          need.size_class,
          need.channels,
          1};
}

/// Returns the need of the ball seen from a direction.
TileNeed need_from(SelectorWorld& world, const glm::dvec3& eye) {
  world.look(eye, {0, 0, 0});
  const ObjectDescription& object = world.scene.objects[0];
  TileNeed need =
      need_for_view(view_geometry(world.camera, world.scene.instances[0], object), ViewPlan{});
  need.light = world.cache.light();
  return need;
}

bool same_key(const TileNeed& a, const TileNeed& b) {
  return a.cell == b.cell && a.distance == b.distance && a.size_class == b.size_class;
}

struct CatalogueTest : ::testing::Test {
  CatalogueTest() {
    front = need_from(world, {0, 0, 5});
    side = need_from(world, {5, 0, 0});
  }
  std::vector<TileNeed> fitted(const TileNeed& need) {
    std::vector<TileNeed> needs = {need};
    catalogue.fit(world.scene, world.cache, needs);
    return needs;
  }
  void tell(std::vector<wire::FrozenTile> tiles, std::vector<wire::FrozenAsset> assets = {}) {
    wire::CatalogueT page;
    page.tiles = std::move(tiles);
    page.assets = std::move(assets);
    ASSERT_TRUE(catalogue.accept(page).ok());
  }

  SelectorWorld world = one_ball(true);
  TileNeed front, side;
  Catalogue catalogue;
};

TEST_F(CatalogueTest, WithoutAFolderNeedsStayAsTheyAre) {
  EXPECT_FALSE(catalogue.there());
  const std::vector<TileNeed> needs = fitted(front);
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_TRUE(same_key(needs[0], front));
}

TEST_F(CatalogueTest, ANeedBecomesTheNearestTile) {
  tell({frozen(front, 0), frozen(side, 0)});
  const std::vector<TileNeed> needs = fitted(need_from(world, {1, 0.5, 5}));
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_TRUE(same_key(needs[0], front));
  const std::vector<TileNeed> other = fitted(need_from(world, {5, 0.5, 1}));
  ASSERT_EQ(other.size(), 1u);
  EXPECT_TRUE(same_key(other[0], side));
}

TEST_F(CatalogueTest, WhatIsHeldOrMissingIsNotAskedFor) {
  tell({frozen(front, 0)});
  ASSERT_EQ(fitted(side).size(), 1u) << "better than nothing";
  const Capture capture = capture_for(front, 1);
  world.cache.insert(0, world.scene, capture, make_tile(capture), world.frame, 0);
  EXPECT_TRUE(fitted(side).empty()) << "the nearest is held";
  TileNeed shadow = front;
  shadow.channels = kShadowTile;
  EXPECT_TRUE(fitted(shadow).empty()) << "the folder has no shadows";
}

TEST_F(CatalogueTest, ATileThatIsGoneGivesWayToTheNext) {
  tell({frozen(front, 0), frozen(side, 0)});
  tell({frozen(front, 0, 0)});
  const std::vector<TileNeed> needs = fitted(front);
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_TRUE(same_key(needs[0], side));
  tell({frozen(side, 0, 0)});
  EXPECT_TRUE(fitted(front).empty());
}

TEST_F(CatalogueTest, GeometryAndImagesTakeTheNearestLevel) {
  tell({}, {{1, 10, 0, 1, false}, {1, 10, 0, 4, false}, {1, 10, 0, 3, true}});
  MeshCache held;
  const auto level = [&](AssetId::Kind kind, std::uint8_t wanted) -> int {
    std::vector<AssetNeed> needs(1);
    needs[0].id = {kind, 0, wanted};
    catalogue.fit(held, needs);
    return needs.empty() ? -1 : needs[0].id.level;
  };
  EXPECT_EQ(level(AssetId::Kind::kMesh, 1), 1);
  EXPECT_EQ(level(AssetId::Kind::kMesh, 3), 1) << "finer rather than coarser";
  EXPECT_EQ(level(AssetId::Kind::kMesh, 0), 1) << "nothing finer is there";
  EXPECT_EQ(level(AssetId::Kind::kMesh, 5), 4);
  EXPECT_EQ(level(AssetId::Kind::kImage, 1), 3);
  EXPECT_EQ(level(AssetId::Kind::kImage, 5), 3);
  tell({}, {{1, 0, 0, 1, false}, {1, 0, 0, 4, false}});
  EXPECT_EQ(level(AssetId::Kind::kMesh, 1), -1);
}

TEST_F(CatalogueTest, PagesBeyondTheLimitsAreErrors) {
  wire::CatalogueT page;
  page.assets.assign(limits::kMaxFrozen + 1, wire::FrozenAsset(1, 1, 0, 0, false));
  EXPECT_FALSE(catalogue.accept(page).ok());
  front.cell.level = 200;
  page.assets.clear();
  page.tiles = {frozen(front, 0)};
  EXPECT_FALSE(Catalogue().accept(page).ok());
}

}  // namespace
}  // namespace mirage::test

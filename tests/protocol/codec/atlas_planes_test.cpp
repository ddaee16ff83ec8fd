// Atlas planes: gutters, and what empty texels beside covered ones get.
#include "protocol/codec/atlas_planes.h"

#include <gtest/gtest.h>

#include "protocol/impostor/tile_key.h"

namespace mirage::test {
namespace {

// Returns a tile of 3 x 1 texels, of which the middle one is empty.
Tile gap(std::uint8_t channels) {
  Tile tile;
  tile.edge = 16;
  tile.crop = {4, 5, 3, 1};
  tile.channels = channels;
  tile.rgba = {10, 20, 30, 255, 0, 0, 0, 0, 40, 50, 60, 255};
  tile.depth = {90, 0, 70};
  tile.surface = {100, 110, 120, 7, 0, 0, 0, 0, 50, 60, 70, 9};
  tile.behind = {0, 0, 0, 0, 8, 16, 24, 255, 0, 0, 0, 0};
  tile.behind_depth = {0, 30, 0};
  tile.shadow = {255, 0, 1};
  return tile;
}

constexpr std::size_t kWide = 5, kTexels = 15;  // with the gutter

TEST(ProtocolAtlasPlanes, LitTilesHaveColourAndDepthThatReachesWhereFilteredColourDoes) {
  const AtlasPlanes planes = atlas_planes(gap(kLitTile));
  ASSERT_EQ(planes.color.size(), kTexels * 4);
  ASSERT_EQ(planes.depth.size(), kTexels);
  EXPECT_EQ(planes.color[(kWide + 1) * 4], 10);
  EXPECT_EQ(planes.color[3], 0) << "the gutter has no colour";
  EXPECT_EQ(planes.depth[kWide + 1], 90);
  EXPECT_EQ(planes.depth[0], 90) << "the gutter has a neighbour's depth";
  EXPECT_EQ(planes.depth[kWide + 2], 70) << "the nearer of two neighbours";
  EXPECT_TRUE(planes.surface.empty() && planes.front_color.empty() && planes.shadow.empty());
}

TEST(ProtocolAtlasPlanes, EmptyTexelsOfRelitTilesGetTheMeanSurface) {
  const AtlasPlanes planes = atlas_planes(gap(kRelitTile));
  ASSERT_EQ(planes.surface.size(), kTexels * 4);
  const std::uint8_t* const middle = &planes.surface[(kWide + 2) * 4];
  EXPECT_EQ(middle[0], 75);
  EXPECT_EQ(middle[2], 95);
  EXPECT_TRUE(middle[3] == 7 || middle[3] == 9) << "a material is never mixed";
}

TEST(ProtocolAtlasPlanes, LayersLieApartAndAsOnePicture) {
  const AtlasPlanes planes = atlas_planes(gap(kLayeredTile));
  const std::size_t middle = kWide + 2;
  EXPECT_EQ(planes.front_color[middle * 4 + 3], 0);
  EXPECT_EQ(planes.front_depth[middle], 0) << "a layer's depth is not continued";
  EXPECT_EQ(planes.behind_color[middle * 4 + 2], 24);
  EXPECT_EQ(planes.behind_depth[middle], 30);
  EXPECT_EQ(planes.color[middle * 4 + 2], 24);
  EXPECT_EQ(planes.color[middle * 4 + 3], 255);
}

TEST(ProtocolAtlasPlanes, ShadowsContinueAndEndAtFullLight) {
  const AtlasPlanes planes = atlas_planes(gap(kShadowTile));
  ASSERT_EQ(planes.shadow.size(), kTexels);
  EXPECT_EQ(planes.shadow[kWide + 1], 255);
  EXPECT_EQ(planes.shadow[kWide + 3], 0);
  EXPECT_EQ(planes.shadow[kWide + 2], 128) << "between light and shadow";
  EXPECT_TRUE(planes.color.empty() && planes.depth.empty());
}

TEST(ProtocolAtlasPlanes, CastersKeepTheirOwnDepthOnly) {
  const AtlasPlanes planes = atlas_planes(gap(kCasterTile));
  EXPECT_EQ(planes.depth[kWide + 1], 90);
  EXPECT_EQ(planes.depth[kWide + 2], 0);
  EXPECT_EQ(planes.depth[0], 0);
}

TEST(ProtocolAtlasPlanes, ComeBackFromBytesOfTheirSizeOnly) {
  for (const std::uint8_t channels :
       {kLitTile, kRelitTile, kLayeredTile, kShadowTile, kCasterTile}) {
    const Tile tile = gap(channels);
    const AtlasPlanes planes = atlas_planes(tile);
    std::vector<std::uint8_t> bytes;
    append_atlas_planes(planes, bytes);
    ASSERT_EQ(bytes.size(), atlas_plane_bytes(tile.crop, channels));
    const Result<AtlasPlanes> back =
        read_atlas_planes(bytes.data(), bytes.size(), tile.crop, channels);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->color, planes.color);
    EXPECT_EQ(back->depth, planes.depth);
    EXPECT_EQ(back->surface, planes.surface);
    EXPECT_EQ(back->behind_color, planes.behind_color);
    EXPECT_EQ(back->behind_depth, planes.behind_depth);
    EXPECT_EQ(back->front_color, planes.front_color);
    EXPECT_EQ(back->front_depth, planes.front_depth);
    EXPECT_EQ(back->shadow, planes.shadow);
    EXPECT_FALSE(read_atlas_planes(bytes.data(), bytes.size() - 1, tile.crop, channels));
  }
}

TEST(ProtocolAtlasPlanes, AnEmptyTileHasNone) {
  Tile tile;
  tile.edge = 16;
  std::vector<std::uint8_t> bytes;
  append_atlas_planes(atlas_planes(tile), bytes);
  EXPECT_TRUE(bytes.empty());
  EXPECT_EQ(atlas_plane_bytes(tile.crop, kLitTile), 0u);
}

}  // namespace
}  // namespace mirage::test

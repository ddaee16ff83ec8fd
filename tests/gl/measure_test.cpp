// Measures of drawn tiles: the fast way of the server against plain loops over all texels.
#include <gtest/gtest.h>

#include "protocol/impostor/capture.h"
#include "server/prepare/prepared_scene.h"
#include "server/tile/tile_encode.h"
#include "tests/bench/drawn_tiles.h"
#include "tests/support/measure_reference.h"

namespace mirage::test {
namespace {

// Returns the codes of the layer behind of a layered tile; empty: it has none.
std::vector<std::uint8_t> farther(const Tile& tile) {
  std::vector<std::uint8_t> out;
  if (!tile.layered()) return out;
  for (std::size_t i = 0; i < tile.depth.size(); ++i) {
    out.push_back(std::max(tile.depth[i], tile.behind_depth[i]));
  }
  return out;
}

TEST(GlMeasure, DrawnTilesMeasureAsInPlainLoops) {
  const Result<std::shared_ptr<const PreparedScene>> scene = load_scene("builtin:forest?trees=8");
  ASSERT_TRUE(scene.ok());
  for (const std::uint8_t channels : {kLitTile, kRelitTile, kLayeredTile}) {
    for (const std::uint32_t edge : {32u, 128u}) {
      const auto drawn = bench::draw_tiles(*scene, 6, edge, channels);
      ASSERT_TRUE(drawn.ok()) << drawn.error().text;
      for (const RenderedTile& rendered : *drawn) {
        const TileKey& key = rendered.job.key;
        const ObjectDescription& object = (*scene)->objects[key.object];
        const Capture capture(key.cell, key.distance, object.radius, edge);
        const Tile tile = cut_and_measure(rendered, object);
        const TileMeasure expected = plain_measure(tile, farther(tile), capture, object);
        const TileMeasure& found = tile.measure;
        EXPECT_EQ(found.plane_depth, expected.plane_depth);
        EXPECT_EQ(found.depth_min, expected.depth_min);
        EXPECT_EQ(found.depth_max, expected.depth_max);
        EXPECT_EQ(found.dz_quad, expected.dz_quad);
        EXPECT_EQ(found.dz_cuboid, expected.dz_cuboid);
        EXPECT_EQ(found.dz_hull, expected.dz_hull);
        EXPECT_EQ(found.depth_gap, expected.depth_gap);
      }
    }
  }
}

}  // namespace
}  // namespace mirage::test

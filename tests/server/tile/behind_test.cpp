// Second layer of layered tiles: unpacked, measured, and dropped if it is not worth its bytes.
#include <gtest/gtest.h>

#include "server/tile/tile_behind.h"
#include "server/tile/tile_measure.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kEdge = 16;
constexpr std::uint8_t kNear = 40, kFar = 200;  // depth codes

/// A page with one tile: a front over all of it except a margin of one texel, and something blue
/// behind the first `behind` texels of each row.
struct PageOfTwo {
  explicit PageOfTwo(std::uint32_t behind) {
    for (std::uint32_t y = 1; y + 1 < kEdge; ++y) {
      for (std::uint32_t x = 1; x + 1 < kEdge; ++x) {
        const std::size_t i = y * kEdge + x;
        std::copy_n(std::begin({200, 100, 50, 255}), 4, &rgba[i * 4]);
        depth[i] = kNear;
        if (x > behind) continue;
        // Full cover is 15: 7 beside red, 1 beside green.
        std::copy_n(std::begin({0 * 8 + 7, 10 * 8 + 4, 31 * 8, int{kFar}}), 4, &surface[i * 4]);
      }
    }
  }
  Tile cut() const {
    ObjectDescription object;
    object.radius = 1;
    object.box_min = glm::vec3(-0.6f);
    object.box_max = glm::vec3(0.6f);
    object.needs = kNeedAlphaMask;
    const Capture capture({4, 3, 3}, *distance_bucket_from_radii(4, 2), 1, kEdge);
    return cut_tile({rgba.data(), depth.data(), surface.data(), kEdge}, kLayeredTile, capture,
                    object);
  }
  std::vector<std::uint8_t> rgba = std::vector<std::uint8_t>(kEdge * kEdge * 4);
  std::vector<std::uint8_t> depth = std::vector<std::uint8_t>(kEdge * kEdge);
  std::vector<std::uint8_t> surface = std::vector<std::uint8_t>(kEdge * kEdge * 4);
};

TEST(ServerBehind, LayersAreCutAndMeasuredOverBoth) {
  const Tile tile = PageOfTwo(8).cut();
  ASSERT_EQ(tile.crop.w, kEdge);
  const std::size_t first = kEdge + 1, last = kEdge + 14;
  EXPECT_EQ(tile.depth[first], kNear);
  EXPECT_EQ(tile.behind_depth[first], kFar);
  EXPECT_EQ(tile.behind_depth[last], 0);
  const std::vector<std::uint8_t> blue(tile.behind.begin() + first * 4,
                                       tile.behind.begin() + first * 4 + 4);
  EXPECT_EQ(blue, (std::vector<std::uint8_t>{0, 82, 255, 255}));
  EXPECT_EQ(tile.behind[last * 4 + 3], 0);
  const Capture capture({4, 3, 3}, *distance_bucket_from_radii(4, 2), 1, kEdge);
  const DepthCode code(1, capture.distance);
  EXPECT_LE(tile.measure.depth_min, code.decode(kNear));
  EXPECT_GE(tile.measure.depth_max, code.decode(kFar)) << "the bound is to cover both";
  EXPECT_EQ(tile.measure.dz_behind, 0) << "it is drawn at its own depth";
}

TEST(ServerBehind, ALayerThatHidesLittleIsLeftOut) {
  const Tile tile = PageOfTwo(1).cut();  // 14 of 196 texels
  EXPECT_EQ(tile.channels, kLayeredTile) << "as asked for";
  EXPECT_EQ(std::count(tile.behind_depth.begin(), tile.behind_depth.end(), 0),
            static_cast<std::ptrdiff_t>(tile.crop.area()));
  EXPECT_EQ(std::count(tile.behind.begin(), tile.behind.end(), 0),
            static_cast<std::ptrdiff_t>(4 * tile.crop.area()));
  EXPECT_EQ(tile.rgba[(kEdge + 1) * 4], 200);
}

}  // namespace
}  // namespace mirage::test

// Tile bytes: how many bytes a tile is expected to take.
#include "client/price/tile_bytes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/impostor/tile.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

void feed(TileBytes& bytes, std::uint8_t size_class, std::uint8_t channels, std::size_t each) {
  for (int i = 0; i < 200; ++i) bytes.arrived(size_class, channels, each);
}

TEST(CoreTileBytes, BeforeAnyHasCome) {
  const TileBytes bytes;
  const double lit = 0.6 * std::sqrt(2.0) * 64 * 64;  // tiles of 128 texels take .6 a texel
  EXPECT_NEAR(bytes.expected(4, kLitTile), 160 + lit, 1e-9);
  EXPECT_NEAR(bytes.expected(4, kRelitTile), 160 + 1.6 * lit, 1e-9);
  EXPECT_NEAR(bytes.expected(4, kShadowTile), 160 + 0.3 * lit, 1e-9);
  EXPECT_NEAR(bytes.expected(0, kLitTile), 160 + lit / 8, 1e-9) << "a quarter of the edge";
}

TEST(CoreTileBytes, EachSizeHasItsOwn) {
  TileBytes bytes;
  feed(bytes, 4, kLitTile, 5000);    // 1.22 bytes a texel
  feed(bytes, 8, kLitTile, 30'000);  // 0.46
  EXPECT_NEAR(bytes.expected(4, kLitTile), 5000, 1);
  EXPECT_NEAR(bytes.expected(8, kLitTile), 30'000, 1);
  // A size that never arrived counts like the nearest one that did, with fewer bytes a texel if
  // larger.
  EXPECT_NEAR(bytes.expected(10, kLitTile), 160 + 30'000 * 4 / std::sqrt(2.0), 10);
  EXPECT_NEAR(bytes.expected(2, kLitTile), 160 + 5000 / 4.0 * std::sqrt(2.0), 10);
}

TEST(CoreTileBytes, AKindThatNeverCameIsJudgedByOthers) {
  TileBytes bytes;
  feed(bytes, 4, kLitTile, 5000);
  EXPECT_NEAR(bytes.expected(4, kRelitTile), 160 + 1.6 * 5000, 10);
  feed(bytes, 8, kRelitTile, 6 * 65'536);
  EXPECT_NEAR(bytes.expected(4, kRelitTile), 160 + 6 * 4096 * 2, 10) << "its own kind, however far";
  EXPECT_NEAR(bytes.expected(4, kLitTile), 5000, 1);
}

TEST(CoreTileBytes, FollowsWhatComesAndOneTileIsNoProof) {
  TileBytes bytes;
  bytes.arrived(4, kLitTile, 200);
  EXPECT_GT(bytes.expected(4, kLitTile), 1000) << "one that was nearly empty";
  feed(bytes, 4, kLitTile, 9000);
  EXPECT_NEAR(bytes.expected(4, kLitTile), 9000, 10);
  feed(bytes, 4, kLitTile, 1000);
  EXPECT_NEAR(bytes.expected(4, kLitTile), 1000, 10);
}

}  // namespace
}  // namespace mirage

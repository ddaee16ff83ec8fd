// Tile planes and depth codes: exact round trips, honest quanta, hostile bytes.
#include "protocol/impostor/tile.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <cmath>
#include <random>

#include "protocol/base/limits.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/codec/tile_color.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"

namespace mirage::test {
namespace {

constexpr TileCodec kLossless[] = {TileCodec::kRaw, TileCodec::kZstd};

Tile make_tile(std::uint32_t w, std::uint32_t h, bool smooth) {
  std::mt19937 random(w * 31 + h);
  Tile tile;
  tile.edge = 256;
  tile.crop = {1, 2, w, h};
  tile.rgba.resize(tile.crop.area() * 4);
  tile.depth.resize(tile.crop.area());
  for (std::size_t i = 0; i < tile.rgba.size(); ++i) {
    tile.rgba[i] = static_cast<std::uint8_t>(smooth ? i / 4 % w + i % 4 * 20 : random());
  }
  for (std::size_t i = 0; i < tile.depth.size(); ++i) {
    tile.depth[i] = static_cast<std::uint8_t>(smooth ? i / w : random());
  }
  return tile;
}

Tile empty_like(const Tile& tile) {
  Tile out = tile;
  out.rgba.clear();
  out.depth.clear();
  return out;
}

TEST(ProtocolTileCodec, RoundTrip) {
  for (const TileCodec codec : kLossless) {
    for (const bool smooth : {false, true}) {
      for (const auto& [w, h] :
           {std::pair{1u, 1u}, {1u, 50u}, {50u, 1u}, {64u, 33u}, {200u, 90u}}) {
        const Tile tile = make_tile(w, h, smooth);
        const auto bytes = encode_tile_planes(tile, codec);
        Tile back = empty_like(tile);
        ASSERT_TRUE(decode_tile_planes(bytes.data(), bytes.size(), codec, back));
        ASSERT_EQ(back.rgba, tile.rgba);
        ASSERT_EQ(back.depth, tile.depth);
        ASSERT_EQ(tile_content_hash(back), tile_content_hash(tile));
      }
    }
  }
}

Tile make_relit(std::uint32_t w, std::uint32_t h) {
  Tile tile = make_tile(w, h, false);
  tile.channels = kRelitTile;
  tile.surface.assign(tile.rgba.rbegin(), tile.rgba.rend());
  return tile;
}

TEST(ProtocolTileCodec, LayeredTilesCarryWhatIsBehind) {
  for (const TileCodec codec : kLossless) {
    Tile tile = make_tile(33, 20, false);
    tile.channels = kLayeredTile;
    tile.behind.assign(tile.rgba.rbegin(), tile.rgba.rend());
    tile.behind_depth.assign(tile.depth.rbegin(), tile.depth.rend());
    const auto bytes = encode_tile_planes(tile, codec);
    Tile back = empty_like(tile);
    back.behind.clear();
    back.behind_depth.clear();
    ASSERT_TRUE(decode_tile_planes(bytes.data(), bytes.size(), codec, back));
    EXPECT_EQ(back.rgba, tile.rgba);
    EXPECT_EQ(back.depth, tile.depth);
    EXPECT_EQ(back.behind, tile.behind);
    EXPECT_EQ(back.behind_depth, tile.behind_depth);
    for (auto plane : {&Tile::behind, &Tile::behind_depth}) {
      Tile other = tile;
      (other.*plane)[7] ^= 1;
      EXPECT_NE(tile_content_hash(other), tile_content_hash(tile));
    }
    // Planes of one kind are not accepted as the other.
    Tile lit = empty_like(tile);
    lit.channels = kLitTile;
    EXPECT_FALSE(decode_tile_planes(bytes.data(), bytes.size(), codec, lit));
  }
}

TEST(ProtocolTileColor, FrontOverBehindAddsWhatTheFrontLeavesOpen) {
  const std::vector<std::uint8_t> behind = {100, 200, 50, 255, 100, 200, 50, 255, 0, 0, 0, 0};
  std::vector<std::uint8_t> front = {9, 8, 7, 255, 0, 0, 0, 0, 60, 50, 40, 100};
  EXPECT_EQ(front_over_behind(front, behind),
            (std::vector<std::uint8_t>{9, 8, 7, 255, 100, 200, 50, 255, 60, 50, 40, 100}));
  // Half of white over white gives white; both halves are added in linear light.
  front = {188, 188, 188, 128, 0, 0, 0, 128, 0, 0, 0, 0};
  const std::vector<std::uint8_t> white(12, 255);
  const std::vector<std::uint8_t> over = front_over_behind(front, white);
  EXPECT_NEAR(over[0], 255, 1);
  EXPECT_EQ(over[3], 255);
  EXPECT_NEAR(over[4], 188, 1);
  EXPECT_EQ(over[7], 255);
  EXPECT_EQ(over[8], 255);
}

TEST(ProtocolTileCodec, RelitTilesCarryTheirSurface) {
  for (const TileCodec codec : kLossless) {
    const Tile tile = make_relit(33, 20);
    const auto bytes = encode_tile_planes(tile, codec);
    Tile back = empty_like(tile);
    back.surface.clear();
    ASSERT_TRUE(decode_tile_planes(bytes.data(), bytes.size(), codec, back));
    EXPECT_EQ(back.rgba, tile.rgba);
    EXPECT_EQ(back.surface, tile.surface);
    EXPECT_EQ(back.depth, tile.depth);
    // Planes of one kind are not accepted as the other.
    Tile lit = empty_like(tile);
    lit.channels = kLitTile;
    EXPECT_FALSE(decode_tile_planes(bytes.data(), bytes.size(), codec, lit));
    const auto lit_bytes = encode_tile_planes(make_tile(33, 20, false), codec);
    EXPECT_FALSE(decode_tile_planes(lit_bytes.data(), lit_bytes.size(), codec, back));
    Tile changed = tile;
    changed.surface[7] ^= 1;
    EXPECT_NE(tile_content_hash(changed), tile_content_hash(tile));
  }
}

TEST(ProtocolTileCodec, SmoothImagesGetSmaller) {
  const Tile tile = make_tile(200, 90, true);
  const auto raw = encode_tile_planes(tile, TileCodec::kRaw);
  EXPECT_EQ(raw.size(), 200u * 90 * 5);
  EXPECT_LT(encode_tile_planes(tile, TileCodec::kZstd).size() * 20, raw.size());
}

TEST(ProtocolTileCodec, EmptyTile) {
  for (const TileCodec codec : kLossless) {
    Tile tile;
    tile.edge = 64;
    const auto bytes = encode_tile_planes(tile, codec);
    EXPECT_TRUE(bytes.empty());
    EXPECT_TRUE(decode_tile_planes(bytes.data(), 0, codec, tile));
    const std::uint8_t one = 0;
    EXPECT_FALSE(decode_tile_planes(&one, 1, codec, tile));
  }
}

TEST(ProtocolTileCodec, ContentHashSeesBothPlanes) {
  Tile tile = make_tile(8, 8, true);
  const std::uint64_t hash = tile_content_hash(tile);
  tile.depth[5] ^= 1;
  EXPECT_NE(tile_content_hash(tile), hash);
  tile.depth[5] ^= 1;
  tile.rgba[5] ^= 1;
  EXPECT_NE(tile_content_hash(tile), hash);
}

void expect_codec_error(const std::vector<std::uint8_t>& bytes, TileCodec codec, Tile tile) {
  const Result<void> result = decode_tile_planes(bytes.data(), bytes.size(), codec, tile);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().id, ErrorId::kCodec);
}

TEST(ProtocolTileCodec, TruncatedAtEveryByte) {
  const Tile tile = make_tile(20, 12, true);
  for (const TileCodec codec : kLossless) {
    const auto bytes = encode_tile_planes(tile, codec);
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      expect_codec_error({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)}, codec,
                         empty_like(tile));
    }
    auto longer = bytes;
    longer.push_back(0);
    expect_codec_error(longer, codec, empty_like(tile));
  }
}

TEST(ProtocolTileCodec, FlippedBitsNeverCrash) {
  const Tile tile = make_tile(40, 25, true);
  for (const TileCodec codec : kTileCodecs) {
    const auto bytes = encode_tile_planes(tile, codec);
    for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
      auto damaged = bytes;
      damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1u << bit % 8));
      Tile back = empty_like(tile);
      const Result<void> result = decode_tile_planes(damaged.data(), damaged.size(), codec, back);
      if (!result) {
        ASSERT_EQ(result.error().id, ErrorId::kCodec);
      } else {
        ASSERT_EQ(back.rgba.size(), tile.rgba.size());
        ASSERT_EQ(back.depth.size(), tile.depth.size());
      }
    }
  }
}

TEST(ProtocolTileCodec, BombIsRefused) {
  // 64 MiB of zeros in a few kilobytes, for a crop of 8 x 8.
  const std::vector<std::uint8_t> zeros(64u << 20);
  const auto bomb = compress_block(zeros.data(), zeros.size());
  EXPECT_LT(bomb.size(), 16384u);
  expect_codec_error(bomb, TileCodec::kZstd, empty_like(make_tile(8, 8, true)));
  EXPECT_FALSE(decompress_block(bomb.data(), bomb.size(), 320));
  // A stream that does not declare its size.
  std::vector<std::uint8_t> stream(ZSTD_compressBound(320));
  ZSTD_CCtx* context = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
  stream.resize(ZSTD_compress2(context, stream.data(), stream.size(), zeros.data(), 320));
  ZSTD_freeCCtx(context);
  expect_codec_error(stream, TileCodec::kZstd, empty_like(make_tile(8, 8, true)));
}

TEST(ProtocolTileCodec, CropAndCodecAreChecked) {
  Tile tile;
  tile.edge = 64;
  tile.crop = {0, 0, limits::kMaxTileEdge + 1, 1};
  expect_codec_error({}, TileCodec::kRaw, tile);
  tile.crop = {0, 0, 1, 0xffffffffu};
  expect_codec_error({}, TileCodec::kRaw, tile);
  tile.crop = {0, 0, 1, 1};
  expect_codec_error({1, 2, 3, 4, 5}, static_cast<TileCodec>(9), tile);
}

TEST(ProtocolBlock, RoundTrip) {
  const std::vector<std::uint8_t> data = {1, 2, 3, 3, 3, 3, 3, 3, 4};
  const auto packed = compress_block(data.data(), data.size());
  EXPECT_EQ(*decompress_block(packed.data(), packed.size(), data.size()), data);
  EXPECT_FALSE(decompress_block(packed.data(), packed.size(), data.size() - 1));
  EXPECT_FALSE(decompress_block(packed.data(), packed.size(), data.size() + 1));
  EXPECT_FALSE(decompress_block(nullptr, 0, 9));
}

TEST(ProtocolDepthCode, QuantumHolds) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double ratio : {1.2, 2.0, 10.0, 1e4}) {
    const double radius = 0.37;
    const DepthCode code(radius, ratio * radius);
    double worst = 0;
    for (int i = 0; i < 100'000; ++i) {
      const double u = i % 2 ? uniform(random) : 1 - 0.01 * uniform(random);
      const double z = code.near_depth + u * (code.far_depth - code.near_depth);
      const double error = std::abs(code.decode(code.encode(z)) - z);
      ASSERT_LE(error, code.quantum() * (1 + 1e-9)) << ratio;
      worst = std::max(worst, error);
    }
    EXPECT_GT(worst, code.quantum() * 0.95);  // the quantum is no larger than it must be
  }
}

TEST(ProtocolDepthCode, MonotoneAndStable) {
  const DepthCode code(2, 5);
  int last = 0;
  for (double z = 2.5; z < 7.6; z += 1e-4) {
    const int c = code.encode(z);
    ASSERT_GE(c, std::max(last, 1));
    last = c;
  }
  EXPECT_EQ(code.encode(-1), 1);
  EXPECT_EQ(code.encode(1e30), 255);
  for (int c = 1; c <= 255; ++c) {
    EXPECT_EQ(code.encode(code.decode(static_cast<std::uint8_t>(c))), c);
    if (c > 1) {
      EXPECT_GT(code.decode(static_cast<std::uint8_t>(c)),
                code.decode(static_cast<std::uint8_t>(c - 1)));
    }
  }
  EXPECT_DOUBLE_EQ(code.decode(1), 3);
  EXPECT_DOUBLE_EQ(code.decode(255), 7);
}

wire::TileReplyT plain_fields() {
  Tile tile = make_tile(20, 10, true);
  tile.measure = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  wire::TileReplyT reply;
  set_tile_fields(tile, reply);
  return reply;
}

TEST(ProtocolTileFields, RoundTrip) {
  const Result<Tile> tile = tile_from_fields(plain_fields());
  ASSERT_TRUE(tile);
  EXPECT_EQ(tile->edge, 256u);
  EXPECT_EQ(tile->crop.x, 1u);
  EXPECT_EQ(tile->crop.y, 2u);
  EXPECT_EQ(tile->crop.w, 20u);
  EXPECT_EQ(tile->crop.h, 10u);
  const TileMeasure& m = tile->measure;
  EXPECT_EQ(m.plane_depth, 1);
  EXPECT_EQ(m.depth_min, 2);
  EXPECT_EQ(m.depth_max, 3);
  EXPECT_EQ(m.dz_quad, 4);
  EXPECT_EQ(m.dz_cuboid, 5);
  EXPECT_EQ(m.dz_hull, 6);
  EXPECT_EQ(m.depth_gap, 7);
  EXPECT_EQ(m.dz_behind, 8);
  EXPECT_EQ(m.lod_error, 9);
}

TEST(ProtocolTileFields, BadFieldsAreRefused) {
  const auto refused = [](const auto& change) {
    wire::TileReplyT reply = plain_fields();
    change(reply);
    const Result<Tile> tile = tile_from_fields(reply);
    ASSERT_FALSE(tile);
    EXPECT_EQ(tile.error().id, ErrorId::kWireValue);
  };
  refused([](auto& r) { r.crop_x = 237; });
  refused([](auto& r) { r.channels = 0; });
  refused([](auto& r) { r.channels = kLitTile | kChannelNormal; });
  refused([](auto& r) { r.channels = 255; });
  refused([](auto& r) { r.crop_y = 247; });
  refused([](auto& r) { r.crop_w = 65535; });
  refused([](auto& r) { r.edge = 3, r.crop_x = r.crop_y = r.crop_w = r.crop_h = 0; });
  refused([](auto& r) { r.edge = limits::kMaxTileEdge + 1; });
  for (const float bad : {std::nanf(""), HUGE_VALF, -1.0f}) {
    refused([bad](auto& r) { r.plane_depth = bad; });
    refused([bad](auto& r) { r.depth_min = bad; });
    refused([bad](auto& r) { r.depth_max = bad; });
    refused([bad](auto& r) { r.dz_quad = bad; });
    refused([bad](auto& r) { r.dz_cuboid = bad; });
    refused([bad](auto& r) { r.dz_hull = bad; });
    refused([bad](auto& r) { r.depth_gap = bad; });
    refused([bad](auto& r) { r.dz_behind = bad; });
    refused([bad](auto& r) { r.lod_error = bad; });
  }
}

}  // namespace
}  // namespace mirage::test

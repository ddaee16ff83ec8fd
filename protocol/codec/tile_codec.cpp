#include "protocol/codec/tile_codec.h"

#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "protocol/base/limits.h"
#include "protocol/codec/color_codec.h"
#include "protocol/codec/tile_color.h"

namespace mirage {
namespace {

constexpr int kLevel = 1;  // higher levels cost 3x the time for under 5 % of the bytes

// Restores red and blue from their differences from green.
void add_green(std::uint8_t* plane, std::size_t texels) {
  for (std::uint8_t* p = plane; p != plane + texels * 4; p += 4) {
    p[0] = static_cast<std::uint8_t>(p[0] + p[1]);
    p[2] = static_cast<std::uint8_t>(p[2] + p[1]);
  }
}

// Left prediction per channel, restarted on every row so that rows stay independent.
void predict(const std::uint8_t* plane, std::size_t width, std::size_t height, std::size_t channels,
             std::uint8_t* out) {
  const std::size_t row = width * channels;
  for (std::size_t y = 0; y < height; ++y, plane += row, out += row) {
    std::copy_n(plane, channels, out);
    for (std::size_t i = channels; i < row; ++i) {
      out[i] = static_cast<std::uint8_t>(plane[i] - plane[i - channels]);
    }
  }
}

// Returns the differences of the four bytes, each on its own.
std::uint32_t bytes_less(std::uint32_t a, std::uint32_t b) {
  constexpr std::uint32_t kTop = 0x80808080;
  return ((a | kTop) - (b & ~kTop)) ^ ((a ^ ~b) & kTop);
}

// Does the same for colours, whose red and blue become differences from green: in a gray tile they
// are 0. Whole texels as integers become vectors, single bytes do not.
void predict_colors(const std::uint8_t* plane, std::size_t width, std::size_t height,
                    std::uint8_t* out) {
  const auto less_green = [](std::uint32_t texel) {
    const std::uint32_t green = texel >> 8 & 0xff;  // bytes from low to high
    return bytes_less(texel, green | green << 16);
  };
  for (std::size_t y = 0; y < height; ++y, plane += width * 4, out += width * 4) {
    std::uint32_t first = 0;
    std::memcpy(&first, plane, 4);
    first = less_green(first);
    std::memcpy(out, &first, 4);
    for (std::size_t i = 4; i < width * 4; i += 4) {
      std::uint32_t texel = 0, left = 0;
      std::memcpy(&texel, plane + i, 4);
      std::memcpy(&left, plane + i - 4, 4);
      const std::uint32_t differs = less_green(bytes_less(texel, left));
      std::memcpy(out + i, &differs, 4);
    }
  }
}

void unpredict(std::uint8_t* plane, std::size_t width, std::size_t height, std::size_t channels) {
  for (std::size_t y = 0; y < height; ++y) {
    std::uint8_t* row = plane + y * width * channels;
    for (std::size_t i = channels; i < width * channels; ++i) {
      row[i] = static_cast<std::uint8_t>(row[i] + row[i - channels]);
    }
  }
}

}  // namespace

namespace {

// Contexts are kept: making one takes longer than compressing a small tile with it.
struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

}  // namespace

std::vector<std::uint8_t> compress_block(const std::uint8_t* bytes, std::size_t size) {
  static thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  const std::size_t most = ZSTD_compressBound(size);
  const std::unique_ptr<std::uint8_t[]> out(new std::uint8_t[most]);  // not filled with zeros
  const std::size_t n = ZSTD_compressCCtx(context.get(), out.get(), most, bytes, size, kLevel);
  return {out.get(), out.get() + (ZSTD_isError(n) ? 0 : n)};
}

Result<std::vector<std::uint8_t>> decompress_block(const std::uint8_t* bytes, std::size_t size,
                                                   std::size_t expected_size) {
  const unsigned long long declared = ZSTD_getFrameContentSize(bytes, size);
  if (declared != expected_size) {
    return make_error(ErrorId::kCodec, "compressed block does not declare the expected " +
                                           std::to_string(expected_size) + " bytes");
  }
  static thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  std::vector<std::uint8_t> out(expected_size);
  const std::size_t n = ZSTD_decompressDCtx(context.get(), out.data(), out.size(), bytes, size);
  if (ZSTD_isError(n) || n != expected_size) {
    return make_error(ErrorId::kCodec, "compressed block is damaged");
  }
  return out;
}

namespace {

using Bytes = std::vector<std::uint8_t>;

// A plane of a tile; kPlanes lists all in wire order.
struct PlaneShape {
  Bytes Tile::*plane;
  std::uint8_t channel;  // the plane exists if the tile has this channel
  std::size_t bytes;     // per texel
};
constexpr PlaneShape kPlanes[] = {
    {&Tile::rgba, kChannelColor, 4},    {&Tile::surface, kChannelNormal, 4},
    {&Tile::depth, kChannelDepth, 1},   {&Tile::shadow, kChannelShadow, 1},
    {&Tile::behind, kChannelBehind, 4}, {&Tile::behind_depth, kChannelBehind, 1},
};
constexpr std::size_t kLengthBytes = 4;  // length of the colour image, which precedes it

// Bytes per texel of a plane in the lossless part. Beside a lossy image, the colour plane is only
// coverage.
std::size_t bytes_per_texel(const PlaneShape& shape, TileCodec codec) {
  return shape.plane == &Tile::rgba && is_lossy(codec) ? 1 : shape.bytes;
}

// True if the plane holds colours; on the wire they are differences from green.
bool holds_colors(const PlaneShape& shape, TileCodec codec) {
  return shape.plane == &Tile::behind || (shape.plane == &Tile::rgba && !is_lossy(codec));
}

std::size_t plane_bytes(const Tile& tile, const PlaneShape& shape, TileCodec codec) {
  return tile.channels & shape.channel ? tile.crop.area() * bytes_per_texel(shape, codec) : 0;
}

std::size_t all_plane_bytes(const Tile& tile, TileCodec codec) {
  std::size_t total = 0;
  for (const PlaneShape& shape : kPlanes) total += plane_bytes(tile, shape, codec);
  return total;
}

Bytes coverage_of(const Bytes& rgba) {
  Bytes alpha(rgba.size() / 4);
  for (std::size_t i = 0; i < alpha.size(); ++i) alpha[i] = rgba[i * 4 + 3];
  return alpha;
}

// Writes all planes one behind another, prepared for a compressor unless `codec` has none.
void lossless_planes(const Tile& tile, TileCodec codec, std::uint8_t* out) {
  for (const PlaneShape& shape : kPlanes) {
    const std::size_t bytes = plane_bytes(tile, shape, codec);
    if (bytes == 0) continue;
    const std::size_t channels = bytes_per_texel(shape, codec);
    const bool coverage = channels != shape.bytes;
    const Bytes alpha = coverage ? coverage_of(tile.rgba) : Bytes{};
    const std::uint8_t* const plane = (coverage ? alpha : tile.*shape.plane).data();
    if (codec == TileCodec::kRaw) {
      std::copy_n(plane, bytes, out);
    } else if (holds_colors(shape, codec)) {
      predict_colors(plane, tile.crop.w, tile.crop.h, out);
    } else {
      predict(plane, tile.crop.w, tile.crop.h, channels, out);
    }
    out += bytes;
  }
}

// The inverse of lossless_planes(): fills the tile. Beside a lossy image it fills only coverage.
void take_planes(Bytes planes, TileCodec codec, Tile& tile) {
  auto at = planes.begin();
  for (const PlaneShape& shape : kPlanes) {
    const auto end = at + static_cast<std::ptrdiff_t>(plane_bytes(tile, shape, codec));
    const std::size_t channels = bytes_per_texel(shape, codec);
    const bool coverage = channels != shape.bytes;
    if (codec != TileCodec::kRaw && at != end) {
      unpredict(&*at, tile.crop.w, tile.crop.h, channels);
      if (holds_colors(shape, codec)) add_green(&*at, tile.crop.area());
    }
    if (coverage) {
      tile.rgba.resize(tile.crop.area() * 4);
      for (std::size_t i = 3; at != end; i += 4) tile.rgba[i] = *at++;
    } else {
      (tile.*shape.plane).assign(at, end);
      at = end;
    }
  }
}

Result<void> decode_lossy(const std::uint8_t* bytes, std::size_t size, TileCodec codec,
                          Tile& tile) {
  std::uint32_t length = 0;
  if (size < kLengthBytes) return make_error(ErrorId::kCodec, "tile bytes end too early");
  for (std::size_t i = kLengthBytes; i-- > 0;) length = length << 8 | bytes[i];
  if (length > size - kLengthBytes) {
    return make_error(ErrorId::kCodec, "tile bytes end within its colours");
  }
  const std::uint8_t* rest = bytes + kLengthBytes + length;
  Result<Bytes> planes =
      decompress_block(rest, size - kLengthBytes - length, all_plane_bytes(tile, codec));
  if (!planes) return planes.error();
  const Result<Bytes> colors =
      decode_webp_colors(bytes + kLengthBytes, length, tile.crop.w, tile.crop.h);
  if (!colors) return colors.error();
  take_planes(planes.take(), codec, tile);
  premultiply_colors(*colors, tile.rgba);
  return {};
}

}  // namespace

const char* codec_name(TileCodec codec) {
  switch (codec) {
    case TileCodec::kRaw:
      return "raw";
    case TileCodec::kZstd:
      return "zstd";
    case TileCodec::kWebp:
      return "webp";
  }
  return "unknown";
}

std::optional<TileCodec> codec_from_name(const std::string& name) {
  for (const TileCodec codec : kTileCodecs) {
    if (name == codec_name(codec)) return codec;
  }
  return std::nullopt;
}

std::vector<std::uint8_t> every_codec() {
  std::vector<std::uint8_t> out;
  out.reserve(kTileCodecs.size());
  for (const TileCodec codec : kTileCodecs) out.push_back(static_cast<std::uint8_t>(codec));
  return out;
}

std::vector<std::uint8_t> encode_tile_planes(const Tile& tile, TileCodec codec) {
  const std::size_t size = all_plane_bytes(tile, codec);
  if (codec == TileCodec::kRaw || size == 0) return raw_tile_planes(tile);
  const std::unique_ptr<std::uint8_t[]> planes(new std::uint8_t[size]);  // not filled with zeros
  lossless_planes(tile, codec, planes.get());
  Bytes rest = compress_block(planes.get(), size);
  if (!is_lossy(codec)) return rest;
  const std::uint32_t w = tile.crop.w, h = tile.crop.h;
  const Bytes colors = encode_webp_colors(straight_colors(tile.rgba, w, h), w, h);
  Bytes out(kLengthBytes);
  for (std::size_t i = 0; i < kLengthBytes; ++i) {
    out[i] = static_cast<std::uint8_t>(colors.size() >> 8 * i);
  }
  out.insert(out.end(), colors.begin(), colors.end());
  out.insert(out.end(), rest.begin(), rest.end());
  return out;
}

Bytes raw_tile_planes(const Tile& tile) {
  Bytes out(all_plane_bytes(tile, TileCodec::kRaw));
  lossless_planes(tile, TileCodec::kRaw, out.data());
  return out;
}

Result<void> decode_tile_planes(const std::uint8_t* bytes, std::size_t size, TileCodec codec,
                                Tile& tile) {
  if (tile.crop.w > limits::kMaxTileEdge || tile.crop.h > limits::kMaxTileEdge) {
    return make_error(ErrorId::kCodec, "tile crop is larger than any tile");
  }
  if (std::find(kTileCodecs.begin(), kTileCodecs.end(), codec) == kTileCodecs.end()) {
    return make_error(ErrorId::kCodec, "unknown tile codec");
  }
  if (is_lossy(codec) && !(tile.channels & kChannelColor)) {
    return make_error(ErrorId::kCodec, "a tile without colours has no lossy form");
  }
  const std::size_t expected = all_plane_bytes(tile, codec);
  if (codec == TileCodec::kRaw || expected == 0) {
    if (size != expected) return make_error(ErrorId::kCodec, "tile bytes do not fit its crop");
    take_planes(Bytes(bytes, bytes + size), TileCodec::kRaw, tile);
    return {};
  }
  if (is_lossy(codec)) return decode_lossy(bytes, size, codec, tile);
  Result<Bytes> planes = decompress_block(bytes, size, expected);
  if (!planes) return planes.error();
  take_planes(planes.take(), codec, tile);
  return {};
}

std::uint64_t tile_content_hash(const Tile& tile) {
  std::uint64_t hash = XXH3_64bits(tile.rgba.data(), tile.rgba.size());
  if (tile.relit()) hash = XXH3_64bits_withSeed(tile.surface.data(), tile.surface.size(), hash);
  hash = XXH3_64bits_withSeed(tile.depth.data(), tile.depth.size(), hash);
  if (tile.channels & kChannelShadow) {
    hash = XXH3_64bits_withSeed(tile.shadow.data(), tile.shadow.size(), hash);
  }
  if (tile.channels & kChannelBehind) {
    hash = XXH3_64bits_withSeed(tile.behind.data(), tile.behind.size(), hash);
    hash = XXH3_64bits_withSeed(tile.behind_depth.data(), tile.behind_depth.size(), hash);
  }
  return hash;
}

}  // namespace mirage

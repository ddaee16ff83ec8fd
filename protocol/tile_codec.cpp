#include "protocol/tile_codec.h"

#include <xxhash.h>
#include <zstd.h>

#include "protocol/limits.h"

namespace mirage {
namespace {

constexpr int kLevel = 1;  // higher levels cost 3x the time for under 5 % of the bytes

// Red and blue as differences from green: of a gray tile they are 0. `sign` -1 takes it away, 1
// puts it back.
void add_green(std::uint8_t* plane, std::size_t texels, int sign) {
  for (std::uint8_t* p = plane; p != plane + texels * 4; p += 4) {
    p[0] = static_cast<std::uint8_t>(p[0] + sign * p[1]);
    p[2] = static_cast<std::uint8_t>(p[2] + sign * p[1]);
  }
}

// Left prediction per channel, restarted on every row so that rows stay independent.
void predict(std::uint8_t* plane, std::size_t width, std::size_t height, std::size_t channels) {
  for (std::size_t y = 0; y < height; ++y) {
    std::uint8_t* row = plane + y * width * channels;
    for (std::size_t i = width * channels; i-- > channels;) {
      row[i] = static_cast<std::uint8_t>(row[i] - row[i - channels]);
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

std::vector<std::uint8_t> compress_block(const std::uint8_t* bytes, std::size_t size) {
  std::vector<std::uint8_t> out(ZSTD_compressBound(size));
  const std::size_t n = ZSTD_compress(out.data(), out.size(), bytes, size, kLevel);
  out.resize(ZSTD_isError(n) ? 0 : n);
  return out;
}

Result<std::vector<std::uint8_t>> decompress_block(const std::uint8_t* bytes, std::size_t size,
                                                   std::size_t expected_size) {
  const unsigned long long declared = ZSTD_getFrameContentSize(bytes, size);
  if (declared != expected_size) {
    return make_error(ErrorId::kCodec, "compressed block does not declare the expected " +
                                           std::to_string(expected_size) + " bytes");
  }
  std::vector<std::uint8_t> out(expected_size);
  const std::size_t n = ZSTD_decompress(out.data(), out.size(), bytes, size);
  if (ZSTD_isError(n) || n != expected_size) {
    return make_error(ErrorId::kCodec, "compressed block is damaged");
  }
  return out;
}

namespace {

// The planes of a tile in their order on the wire.
struct PlaneShape {
  std::vector<std::uint8_t> Tile::*plane;
  std::uint8_t channel;  // the tile has it with this channel
  std::size_t bytes;     // per texel
};
constexpr PlaneShape kPlanes[] = {
    {&Tile::rgba, kChannelColor, 4},
    {&Tile::surface, kChannelNormal, 4},
    {&Tile::depth, kChannelDepth, 1},
    {&Tile::shadow, kChannelShadow, 1},
};

std::size_t plane_bytes(const Tile& tile, const PlaneShape& shape) {
  return tile.channels & shape.channel ? tile.crop.area() * shape.bytes : 0;
}

}  // namespace

std::vector<std::uint8_t> encode_tile_planes(const Tile& tile, TileCodec codec) {
  std::vector<std::uint8_t> planes;
  std::size_t total = 0;
  for (const PlaneShape& shape : kPlanes) total += plane_bytes(tile, shape);
  planes.reserve(total);
  for (const PlaneShape& shape : kPlanes) {
    if (!(tile.channels & shape.channel)) continue;
    const std::vector<std::uint8_t>& plane = tile.*shape.plane;
    planes.insert(planes.end(), plane.begin(), plane.end());
    if (codec == TileCodec::kRaw) continue;
    std::uint8_t* put = planes.data() + (planes.size() - plane.size());
    if (shape.plane == &Tile::rgba) add_green(put, tile.crop.area(), -1);
    predict(put, tile.crop.w, tile.crop.h, shape.bytes);
  }
  if (codec == TileCodec::kRaw || planes.empty()) return planes;
  return compress_block(planes.data(), planes.size());
}

Result<void> decode_tile_planes(const std::uint8_t* bytes, std::size_t size, TileCodec codec,
                                Tile& tile) {
  if (tile.crop.w > limits::kMaxTileEdge || tile.crop.h > limits::kMaxTileEdge) {
    return make_error(ErrorId::kCodec, "tile crop is larger than any tile");
  }
  std::size_t expected = 0;
  for (const PlaneShape& shape : kPlanes) expected += plane_bytes(tile, shape);
  std::vector<std::uint8_t> planes;
  const bool raw = codec == TileCodec::kRaw || tile.crop.area() == 0;
  if (raw) {
    if (size != expected) return make_error(ErrorId::kCodec, "tile bytes do not fit its crop");
    planes.assign(bytes, bytes + size);
  } else if (codec == TileCodec::kZstd) {
    Result<std::vector<std::uint8_t>> block = decompress_block(bytes, size, expected);
    if (!block) return block.error();
    planes = block.take();
  } else {
    return make_error(ErrorId::kCodec, "unknown tile codec");
  }
  auto at = planes.begin();
  for (const PlaneShape& shape : kPlanes) {
    const auto end = at + static_cast<std::ptrdiff_t>(plane_bytes(tile, shape));
    if (!raw && at != end) {
      unpredict(&*at, tile.crop.w, tile.crop.h, shape.bytes);
      if (shape.plane == &Tile::rgba) add_green(&*at, tile.crop.area(), 1);
    }
    (tile.*shape.plane).assign(at, end);
    at = end;
  }
  return {};
}

std::uint64_t tile_content_hash(const Tile& tile) {
  std::uint64_t hash = XXH3_64bits(tile.rgba.data(), tile.rgba.size());
  if (tile.relit()) hash = XXH3_64bits_withSeed(tile.surface.data(), tile.surface.size(), hash);
  hash = XXH3_64bits_withSeed(tile.depth.data(), tile.depth.size(), hash);
  if (tile.channels & kChannelShadow) {
    hash = XXH3_64bits_withSeed(tile.shadow.data(), tile.shadow.size(), hash);
  }
  return hash;
}

}  // namespace mirage

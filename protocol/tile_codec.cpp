#include "protocol/tile_codec.h"

#include <xxhash.h>
#include <zstd.h>

#include "protocol/limits.h"

namespace mirage {
namespace {

constexpr int kLevel = 1;  // higher levels cost 3x the time for under 5 % of the bytes

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

std::vector<std::uint8_t> encode_tile_planes(const Tile& tile, TileCodec codec) {
  std::vector<std::uint8_t> planes;
  planes.reserve(tile.rgba.size() + tile.depth.size());
  planes.insert(planes.end(), tile.rgba.begin(), tile.rgba.end());
  planes.insert(planes.end(), tile.depth.begin(), tile.depth.end());
  if (codec == TileCodec::kRaw || planes.empty()) return planes;
  predict(planes.data(), tile.crop.w, tile.crop.h, 4);
  predict(planes.data() + tile.rgba.size(), tile.crop.w, tile.crop.h, 1);
  return compress_block(planes.data(), planes.size());
}

Result<void> decode_tile_planes(const std::uint8_t* bytes, std::size_t size, TileCodec codec,
                                Tile& tile) {
  const std::size_t area = tile.crop.area();
  if (tile.crop.w > limits::kMaxTileEdge || tile.crop.h > limits::kMaxTileEdge) {
    return make_error(ErrorId::kCodec, "tile crop is larger than any tile");
  }
  const std::size_t expected = area * 5;
  std::vector<std::uint8_t> planes;
  if (codec == TileCodec::kRaw || area == 0) {
    if (size != expected) return make_error(ErrorId::kCodec, "tile bytes do not fit its crop");
    planes.assign(bytes, bytes + size);
  } else if (codec == TileCodec::kZstd) {
    Result<std::vector<std::uint8_t>> block = decompress_block(bytes, size, expected);
    if (!block) return block.error();
    planes = block.take();
    unpredict(planes.data(), tile.crop.w, tile.crop.h, 4);
    unpredict(planes.data() + area * 4, tile.crop.w, tile.crop.h, 1);
  } else {
    return make_error(ErrorId::kCodec, "unknown tile codec");
  }
  tile.rgba.assign(planes.begin(), planes.begin() + static_cast<std::ptrdiff_t>(area * 4));
  tile.depth.assign(planes.begin() + static_cast<std::ptrdiff_t>(area * 4), planes.end());
  return {};
}

std::uint64_t tile_content_hash(const Tile& tile) {
  const std::uint64_t color = XXH3_64bits(tile.rgba.data(), tile.rgba.size());
  return XXH3_64bits_withSeed(tile.depth.data(), tile.depth.size(), color);
}

}  // namespace mirage

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
  planes.reserve(tile.rgba.size() + tile.surface.size() + tile.depth.size());
  planes.insert(planes.end(), tile.rgba.begin(), tile.rgba.end());
  planes.insert(planes.end(), tile.surface.begin(), tile.surface.end());
  planes.insert(planes.end(), tile.depth.begin(), tile.depth.end());
  if (codec == TileCodec::kRaw || planes.empty()) return planes;
  std::uint8_t* plane = planes.data();
  for (const std::vector<std::uint8_t>* four : {&tile.rgba, &tile.surface}) {
    if (four->empty()) continue;
    predict(plane, tile.crop.w, tile.crop.h, 4);
    plane += four->size();
  }
  predict(plane, tile.crop.w, tile.crop.h, 1);
  return compress_block(planes.data(), planes.size());
}

Result<void> decode_tile_planes(const std::uint8_t* bytes, std::size_t size, TileCodec codec,
                                Tile& tile) {
  const std::size_t area = tile.crop.area();
  if (tile.crop.w > limits::kMaxTileEdge || tile.crop.h > limits::kMaxTileEdge) {
    return make_error(ErrorId::kCodec, "tile crop is larger than any tile");
  }
  const std::size_t four = area * 4, surface = tile.relit() ? four : 0;
  const std::size_t expected = four + surface + area;
  std::vector<std::uint8_t> planes;
  if (codec == TileCodec::kRaw || area == 0) {
    if (size != expected) return make_error(ErrorId::kCodec, "tile bytes do not fit its crop");
    planes.assign(bytes, bytes + size);
  } else if (codec == TileCodec::kZstd) {
    Result<std::vector<std::uint8_t>> block = decompress_block(bytes, size, expected);
    if (!block) return block.error();
    planes = block.take();
    unpredict(planes.data(), tile.crop.w, tile.crop.h, 4);
    if (surface > 0) unpredict(planes.data() + four, tile.crop.w, tile.crop.h, 4);
    unpredict(planes.data() + four + surface, tile.crop.w, tile.crop.h, 1);
  } else {
    return make_error(ErrorId::kCodec, "unknown tile codec");
  }
  const auto at = [&](std::size_t n) { return planes.begin() + static_cast<std::ptrdiff_t>(n); };
  tile.rgba.assign(planes.begin(), at(four));
  tile.surface.assign(at(four), at(four + surface));
  tile.depth.assign(at(four + surface), planes.end());
  return {};
}

std::uint64_t tile_content_hash(const Tile& tile) {
  std::uint64_t hash = XXH3_64bits(tile.rgba.data(), tile.rgba.size());
  if (tile.relit()) hash = XXH3_64bits_withSeed(tile.surface.data(), tile.surface.size(), hash);
  return XXH3_64bits_withSeed(tile.depth.data(), tile.depth.size(), hash);
}

}  // namespace mirage

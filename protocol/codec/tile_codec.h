#pragma once
// Tiles as bytes. The codec is not part of the key: each codec gives another form of the same tile.

#include <cstdint>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/codec/codec_id.h"
#include "protocol/impostor/tile.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

/// Names the form of a tile in one codec.
struct FormId {
  TileId id;
  TileCodec codec = TileCodec::kZstd;
  bool operator<(const FormId& o) const { return id == o.id ? codec < o.codec : id < o.id; }
};

/// Encodes the planes of colour, surface, depth and shadow that the tile's channels name.
///
/// `kZstd` subtracts green from red and blue, so that gray costs one channel (in the forest 9 % of
/// a tile less). It then predicts each byte from the same channel of its left neighbour, which
/// makes smooth images smaller at almost no time.
///
/// A lossy codec needs a tile with colour. It writes an image of the colours divided by coverage
/// and continued into empty texels (tile_color.h, color_codec.h), then alpha and the other planes
/// as `kZstd`.
std::vector<std::uint8_t> encode_tile_planes(const Tile& tile, TileCodec codec);
/// Returns the planes as `kRaw`, for programs without encoders.
std::vector<std::uint8_t> raw_tile_planes(const Tile& tile);

/// Fills the planes of `tile`, whose crop and channels give the exact size. Nothing is allocated
/// before the sizes agree, so a decompression bomb cannot grow past the crop. Error kCodec.
Result<void> decode_tile_planes(const std::uint8_t* bytes, std::size_t size, TileCodec codec,
                                Tile& tile);

/// Returns a 64-bit hash of all planes, for verification. The hash of a lossy form is that of its
/// decoded planes.
std::uint64_t tile_content_hash(const Tile& tile);

/// Compresses any block with zstd, for meshes and reference frames. Decompression is bounded by
/// `expected_size`.
std::vector<std::uint8_t> compress_block(const std::uint8_t* bytes, std::size_t size);
Result<std::vector<std::uint8_t>> decompress_block(const std::uint8_t* bytes, std::size_t size,
                                                   std::size_t expected_size);

}  // namespace mirage

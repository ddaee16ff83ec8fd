#pragma once
// Tile bytes. The codec is no part of the key: it is one form of the same tile.

#include <cstdint>
#include <vector>

#include "protocol/result.h"
#include "protocol/tile.h"

namespace mirage {

enum class TileCodec : std::uint8_t { kRaw = 0, kZstd = 1 };

/// Of colour, surface, depth and shadow the planes its channels name. `kZstd` takes green from red
/// and blue, so that gray costs one channel (of the forest's colours 9 % of a tile), and predicts
/// each byte from its left neighbour's channel, which makes smooth images smaller at almost no
/// time.
std::vector<std::uint8_t> encode_tile_planes(const Tile& tile, TileCodec codec);

/// Fills the planes of `tile`, whose crop and channels say the exact size. Nothing is allocated
/// before the sizes agree; a bomb cannot grow past the crop. Errors: kCodec.
Result<void> decode_tile_planes(const std::uint8_t* bytes, std::size_t size, TileCodec codec,
                                Tile& tile);

/// 64-bit hash of all planes, for verification.
std::uint64_t tile_content_hash(const Tile& tile);

/// zstd of any block, for meshes and reference frames; decode is bounded by `expected_size`.
std::vector<std::uint8_t> compress_block(const std::uint8_t* bytes, std::size_t size);
Result<std::vector<std::uint8_t>> decompress_block(const std::uint8_t* bytes, std::size_t size,
                                                   std::size_t expected_size);

}  // namespace mirage

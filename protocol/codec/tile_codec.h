#pragma once
// Tile bytes. The codec is no part of the key: it is one form of the same tile.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/tile.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

/// The numbers are those on the wire (README.md of this folder).
enum class TileCodec : std::uint8_t { kRaw = 0, kZstd = 1, kWebp = 3 };
inline constexpr std::array<TileCodec, 3> kTileCodecs = {TileCodec::kRaw, TileCodec::kZstd,
                                                         TileCodec::kWebp};
inline constexpr std::size_t kCodecNumbers = 4;  ///< what is indexed by number has so many places

/// A tile in the form that is made for a codec.
struct FormId {
  TileId id;
  TileCodec codec = TileCodec::kZstd;
  bool operator<(const FormId& o) const { return id == o.id ? codec < o.codec : id < o.id; }
};

/// In lower case, as on command lines; "unknown" for what is none.
const char* codec_name(TileCodec codec);
std::optional<TileCodec> codec_from_name(const std::string& name);
/// All of them, as a Hello lists them.
std::vector<std::uint8_t> every_codec();
/// Colours come back within an error; coverage, depth, normals and shadows always as they were.
inline bool is_lossy(TileCodec codec) { return codec == TileCodec::kWebp; }

/// Of colour, surface, depth and shadow the planes its channels name.
/// `kZstd` takes green from red and blue, so that gray costs one channel (of the forest's colours
/// 9 % of a tile), and predicts each byte from its left neighbour's channel, which makes smooth
/// images smaller at almost no time.
/// A lossy codec needs a tile with colour: an image of the colours divided by coverage, continued
/// into what is empty (tile_color.h, color_codec.h), then alpha and the other planes as `kZstd`.
std::vector<std::uint8_t> encode_tile_planes(const Tile& tile, TileCodec codec);
/// As `kRaw`, for who has no encoders.
std::vector<std::uint8_t> raw_tile_planes(const Tile& tile);

/// Fills the planes of `tile`, whose crop and channels say the exact size. Nothing is allocated
/// before the sizes agree; a bomb cannot grow past the crop. Errors: kCodec.
Result<void> decode_tile_planes(const std::uint8_t* bytes, std::size_t size, TileCodec codec,
                                Tile& tile);

/// 64-bit hash of all planes, for verification: of a lossy form, of what it decodes to.
std::uint64_t tile_content_hash(const Tile& tile);

/// zstd of any block, for meshes and reference frames; decode is bounded by `expected_size`.
std::vector<std::uint8_t> compress_block(const std::uint8_t* bytes, std::size_t size);
Result<std::vector<std::uint8_t>> decompress_block(const std::uint8_t* bytes, std::size_t size,
                                                   std::size_t expected_size);

}  // namespace mirage

#pragma once
// Codec id: the codecs of tiles by number and name.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mirage {

/// The values are those on the wire (README.md of this folder).
enum class TileCodec : std::uint8_t { kRaw = 0, kZstd = 1, kWebp = 3 };
inline constexpr std::array<TileCodec, 3> kTileCodecs = {TileCodec::kRaw, TileCodec::kZstd,
                                                         TileCodec::kWebp};
inline constexpr std::size_t kCodecNumbers = 4;  ///< size of arrays indexed by codec

/// Returns the name in lower case, as on command lines; "unknown" for an invalid codec.
const char* codec_name(TileCodec codec);
std::optional<TileCodec> codec_from_name(const std::string& name);
/// Returns all codecs, as a Hello lists them.
std::vector<std::uint8_t> every_codec();
/// True if colours come back with an error. Coverage, depth, normals and shadows are always exact.
inline bool is_lossy(TileCodec codec) { return codec == TileCodec::kWebp; }

}  // namespace mirage

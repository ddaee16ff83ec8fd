#pragma once
// Lossy images of a tile's straight colours (tile_color.h): w x h x 4 bytes, the fourth of no
// account. The encoder is a pure function; the decoder takes hostile bytes: the size must be as
// expected, which is checked before allocating. Error kCodec.

#include <cstdint>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/codec/tile_codec.h"

namespace mirage {

using ColorBytes = std::vector<std::uint8_t>;

/// Colours are a fifth to a third of a tile, the rest is depth: 90 for 80 is 2.4 dB for 12 % of the
/// bytes.
inline constexpr float kTileWebpQuality = 90;
/// WebP (VP8, 4:2:0): fewest bytes, most time. `quality`: 0 to 100.
ColorBytes encode_webp_colors(const ColorBytes& colors, std::uint32_t w, std::uint32_t h,
                              float quality = kTileWebpQuality);
Result<ColorBytes> decode_webp_colors(const std::uint8_t* bytes, std::size_t size, std::uint32_t w,
                                      std::uint32_t h);

}  // namespace mirage

#pragma once
// Lossy images of a tile's straight colours (tile_color.h): w x h x 4 bytes; the fourth of each
// texel is ignored. The encoder is a pure function. The decoder takes hostile bytes: it checks that
// the size is the expected one before it allocates. Error kCodec.

#include <cstdint>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/codec/tile_codec.h"

namespace mirage {

using ColorBytes = std::vector<std::uint8_t>;

/// Colours are a fifth to a third of a tile's bytes; the rest is depth. Quality 90 instead of 80
/// gains 2.4 dB for 12 % more bytes.
inline constexpr float kTileWebpQuality = 90;
/// WebP (VP8, 4:2:0): the fewest bytes and the most time. `quality`: 0 to 100.
ColorBytes encode_webp_colors(const ColorBytes& colors, std::uint32_t w, std::uint32_t h,
                              float quality = kTileWebpQuality);
Result<ColorBytes> decode_webp_colors(const std::uint8_t* bytes, std::size_t size, std::uint32_t w,
                                      std::uint32_t h);

}  // namespace mirage

#pragma once
// A tile's colours prepared for a lossy image codec, and the error of the codec.

#include <cstdint>
#include <vector>

#include "protocol/impostor/tile.h"

namespace mirage {

/// Returns w x h x 4: each colour divided by its coverage, in linear light and encoded as sRGB
/// again, so that a silhouette is no edge in the colours. A texel without coverage takes the mean
/// of the smallest square of 2, 4, 8 … texels that has coverage. The fourth byte is 255.
std::vector<std::uint8_t> straight_colors(const std::vector<std::uint8_t>& rgba, std::uint32_t w,
                                          std::uint32_t h);
/// The inverse: multiplies `straight` (w x h x 4) by the coverage in `rgba`. Texels without
/// coverage become black.
void premultiply_colors(const std::vector<std::uint8_t>& straight, std::vector<std::uint8_t>& rgba);

/// Composes `front` over `behind`, both premultiplied and of the same size, in linear light encoded
/// as sRGB.
std::vector<std::uint8_t> front_over_behind(const std::vector<std::uint8_t>& front,
                                            const std::vector<std::uint8_t>& behind);

/// Error of the premultiplied colours over texels with coverage and all three components, in 1/255.
struct ColorError {
  float rms = 0;
  std::uint8_t max = 0;
};
/// Compares two colour planes, both w x h x 4 and of the same size.
ColorError color_error(const std::vector<std::uint8_t>& original,
                       const std::vector<std::uint8_t>& decoded);

}  // namespace mirage

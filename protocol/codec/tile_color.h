#pragma once
// The colours of a tile as a lossy image codec wants them, and what it did to them.

#include <cstdint>
#include <vector>

#include "protocol/impostor/tile.h"

namespace mirage {

/// w x h x 4: each colour divided by its coverage (both in linear light, sRGB-encoded again), so
/// that an edge is no edge of the colour; texels without coverage take the mean of the smallest
/// square of 2, 4, 8 … texels that has any. The fourth byte is 255.
std::vector<std::uint8_t> straight_colors(const std::vector<std::uint8_t>& rgba, std::uint32_t w,
                                          std::uint32_t h);
/// Back: `straight` (w x h x 4) multiplied by the coverage already in `rgba`. What has no coverage
/// has no colour.
void premultiply_colors(const std::vector<std::uint8_t>& straight, std::vector<std::uint8_t>& rgba);

/// `front` over `behind`, both premultiplied and of the same size: in linear light, sRGB-encoded.
std::vector<std::uint8_t> front_over_behind(const std::vector<std::uint8_t>& front,
                                            const std::vector<std::uint8_t>& behind);

/// Of the premultiplied colours of texels with coverage, all three components, in 1/255.
struct ColorError {
  float rms = 0;
  std::uint8_t max = 0;
};
/// Both w x h x 4 and of the same size.
ColorError color_error(const std::vector<std::uint8_t>& original,
                       const std::vector<std::uint8_t>& decoded);

}  // namespace mirage

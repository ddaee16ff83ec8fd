#pragma once
// Leaving out lobes (rule 13), and the questions that rules ask about a texture.

#include <array>
#include <functional>

#include "server/prepare/leave_out.h"

namespace mirage {

/// Least and greatest value of each channel over all texels.
struct TexelRange {
  std::array<std::uint8_t, 4> low{255, 255, 255, 255}, high{0, 0, 0, 0};
  bool always(std::size_t channel, std::uint8_t value) const {
    return low[channel] == value && high[channel] == value;
  }
  bool white() const { return always(0, 255) && always(1, 255) && always(2, 255); }
  bool black() const { return always(0, 0) && always(1, 0) && always(2, 0); }
};

TexelRange texel_range(const Image& image);

/// Resets lobes whose factor is 0 or whose map is black to a material's defaults, and drops maps
/// that are white. An unlit material has no lobes.
void leave_out_lobes(Material& material,
                     const std::function<TexelRange(const TextureRef&)>& range_of,
                     std::vector<LeftOut>& out);

}  // namespace mirage

#pragma once
// Counts of what a session received.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/codec/codec_id.h"

namespace mirage {

struct TileCounts {
  std::uint64_t asked = 0, received = 0, drawn = 0, wasted = 0, cancelled = 0, refused = 0;
};

/// Counts of the tiles that came in one codec.
struct CodecUse {
  std::uint64_t tiles = 0;
  std::uint64_t bytes = 0;       ///< bytes of their planes
  std::vector<float> color_rms;  ///< error of each lossy tile, 1/255
  std::uint8_t color_max = 0;    ///< largest error of a texel, 1/255
};
using CodecUses = std::array<CodecUse, kCodecNumbers>;

struct ViewCounts {
  std::uint64_t asked = 0;
  std::uint64_t drawn = 0;  ///< those shown in some frame
};

}  // namespace mirage

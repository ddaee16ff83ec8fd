#pragma once
// What a session counts of what it was sent.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/codec/tile_codec.h"

namespace mirage {

struct TileCounts {
  std::uint64_t asked = 0, received = 0, drawn = 0, wasted = 0, cancelled = 0, refused = 0;
};

/// Of the tiles that came in one codec.
struct CodecUse {
  std::uint64_t tiles = 0;
  std::uint64_t bytes = 0;       ///< of their planes
  std::vector<float> color_rms;  ///< of lossy ones, each tile's, 1/255
  std::uint8_t color_max = 0;    ///< of any texel, 1/255
};
using CodecUses = std::array<CodecUse, kCodecNumbers>;

struct ViewCounts {
  std::uint64_t asked = 0;
  std::uint64_t drawn = 0;  ///< that some frame showed
};

}  // namespace mirage

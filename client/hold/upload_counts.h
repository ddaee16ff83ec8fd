#pragma once

#include <cstdint>

namespace mirage {

/// Counts of uploads to the graphics card: tiles with gutters and all planes, geometry, images.
struct UploadCounts {
  std::uint64_t tiles = 0;
  std::uint64_t bytes = 0;
  std::uint64_t largest_frame_bytes = 0;
  std::uint64_t frames_over_budget = 0;  ///< frames in which more than the budget was there
};

}  // namespace mirage

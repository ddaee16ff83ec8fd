#pragma once
// Video codec: the video of the baseline, really encoded (x264 veryfast, zerolatency) and decoded.

#include <cstdint>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct CodedFrame {
  std::size_t bytes = 0;
  std::vector<std::uint8_t> rgba;  ///< decoded, alpha 255
};

struct CodedVideo {
  std::vector<CodedFrame> frames;
  double encode_ms = 0, decode_ms = 0;  ///< medians per frame, wall time
};

/// Encodes frames (RGBA8, rows from the top) at a constant rate and decodes them. The buffer holds
/// one frame, so that no frame waits for another. Error kCodec.
Result<CodedVideo> code_video(const std::vector<const std::uint8_t*>& frames, int width, int height,
                              double fps, double rate_mbps);

}  // namespace mirage

#pragma once
// Video codec: the video of the baseline, really encoded (x264 veryfast, zerolatency) and decoded.
// The module libmirage_video.so holds libavcodec.

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
/// one frame, so that no frame waits for another. The first call loads the module. Errors: kCodec,
/// kModule.
Result<CodedVideo> code_video(const std::vector<const std::uint8_t*>& frames, int width, int height,
                              double fps, double rate_mbps);

/// Name and type of the module's only function; its number grows with each change of either.
inline constexpr const char* kVideoCodecEntry = "mirage_code_video_1";
using VideoCodecEntry = void (*)(const std::vector<const std::uint8_t*>& frames, int width,
                                 int height, double fps, double rate_mbps, Result<CodedVideo>& out);

}  // namespace mirage

#include "client/report/video_codec.h"

#include "modules/module.h"

namespace mirage {

Result<CodedVideo> code_video(const std::vector<const std::uint8_t*>& frames, int width, int height,
                              double fps, double rate_mbps) {
  static const Result<void*> entry = load_module("mirage_video", kVideoCodecEntry);
  if (!entry) return entry.error();
  Result<CodedVideo> out = CodedVideo{};
  reinterpret_cast<VideoCodecEntry> (*entry)(frames, width, height, fps, rate_mbps, out);
  return out;
}

}  // namespace mirage

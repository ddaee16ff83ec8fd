#pragma once
// Header of a KTX2 file (Khronos KTX File Format 2.0, sections 3 and 4). It is judged before the
// transcoder sees the file, so that the transcoder only meets sizes that we know.

#include <cstdint>
#include <span>

#include "protocol/base/result.h"

namespace mirage {

inline constexpr std::uint32_t kMaxKtx2Size = 16384;  ///< pixels along an edge
/// Pixels of a level that is decoded. Few bytes can claim many pixels, and each takes 30 ns or
/// more.
inline constexpr std::uint64_t kMaxKtx2Pixels = 64ull << 20;

struct Ktx2Header {
  std::uint32_t width = 0, height = 0;  ///< pixels of level 0
  std::uint32_t levels = 1;             ///< mip levels in the file

  std::uint32_t width_of(std::uint32_t level) const { return width >> level ? width >> level : 1; }
  std::uint32_t height_of(std::uint32_t level) const {
    return height >> level ? height >> level : 1;
  }
};

/// Accepts one 2D picture of ETC1S or UASTC whose parts lie inside `bytes`. Error kSceneFormat.
Result<Ktx2Header> read_ktx2_header(std::span<const std::uint8_t> bytes);

}  // namespace mirage

#pragma once

#include <cstdint>

namespace mirage {

/// A frame's way with the picture that is there.
enum class FrameStep : std::uint8_t {
  kKeep,    ///< the picture would not change
  kDraw,    ///< draw a new picture
  kRefine,  ///< refine the same picture
};

}  // namespace mirage

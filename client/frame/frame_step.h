#pragma once

#include <cstdint>

namespace mirage {

/// A frame's way with the picture that is there, in the order of what it takes.
enum class FrameStep : std::uint8_t {
  kKeep,    ///< the picture would not change
  kRefine,  ///< refine the same picture
  kDraw,    ///< draw a new picture
};

}  // namespace mirage

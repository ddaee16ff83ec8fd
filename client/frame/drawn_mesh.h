#pragma once
#include <cstdint>

namespace mirage {

/// An instance drawn as geometry.
struct DrawnMesh {
  std::uint32_t instance = 0;
  std::uint8_t lod = 0;
  float fade = 1;      ///< opacity
  bool plain = false;  ///< an image of it shows its mean colour only
};

}  // namespace mirage

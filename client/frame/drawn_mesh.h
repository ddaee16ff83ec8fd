#pragma once
#include <cstdint>

namespace mirage {

/// An instance drawn as geometry.
struct DrawnMesh {
  std::uint32_t instance = 0;
  std::uint8_t lod = 0;
  float fade = 1;      ///< opacity, 0..1
  bool plain = false;  ///< true if one of its images shows only its mean colour
};

}  // namespace mirage

#pragma once

#include <cstddef>

namespace mirage {

/// Bytes of graphics memory by what they are for.
struct GpuBytes {
  std::size_t atlas = 0;     ///< tiles, all planes
  std::size_t geometry = 0;  ///< meshes and their images
  std::size_t shadows = 0;   ///< atlas of shadow and caster tiles, and the map
  std::size_t view = 0;      ///< the view tile
  std::size_t all() const { return atlas + geometry + shadows + view; }
};

}  // namespace mirage

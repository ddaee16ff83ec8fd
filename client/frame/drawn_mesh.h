#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/model/model.h"

namespace mirage {

/// An instance drawn as geometry.
struct DrawnMesh {
  std::uint32_t instance = 0;
  std::uint8_t lod = 0;
  float fade = 1;      ///< opacity, 0..1
  bool plain = false;  ///< true if one of its images shows only its mean colour
  /// Runs of indices that are drawn, of a mesh in patches (client/hold/patches.h); nullopt: all.
  std::optional<std::vector<IndexRun>> runs{};
};

/// Returns the number of triangles in runs.
inline double triangles_in(const std::vector<IndexRun>& runs) {
  double corners = 0;
  for (const IndexRun& run : runs) corners += run.count;
  return corners / 3;
}

}  // namespace mirage

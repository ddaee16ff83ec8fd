#pragma once
// Geometry and images: what is wanted, and what is to be asked for.

#include <cstdint>

#include "client/frame/asset_id.h"

namespace mirage {

/// An object that should be geometry, by its nearest instance (plan/mesh_wants.h).
struct MeshWant {
  std::uint32_t object = 0;
  double px_per_unit = 0;  ///< as of px_per_unit()
  double gain = 0;         ///< what its geometry is worth (ask_gain.h)
  double area_px = 0;      ///< that it covers
  double life_s = 0;       ///< for which it will serve
  bool unseen = false;     ///< the view tile shows nothing fit of it meanwhile
  bool surrounds = false;  ///< one stands in it: nothing is worth more
};

/// Geometry worth asking for.
struct AssetNeed {
  AssetId id;
  double gain = 0;            ///< what it is worth (ask_gain.h); infinite: one stands in it
  double expected_bytes = 0;  ///< of the reply
  bool first = false;         ///< geometry of what is shown by nothing of its own
};

}  // namespace mirage

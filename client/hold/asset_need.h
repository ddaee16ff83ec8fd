#pragma once
// Needs of geometry and images: what the client wants to draw, and what it should ask for.

#include <cstdint>

#include "client/frame/asset_id.h"

namespace mirage {

/// An object that should be drawn as geometry, judged at its nearest instance (plan/mesh_wants.h).
struct MeshWant {
  std::uint32_t object = 0;
  double px_per_unit = 0;  ///< value of px_per_unit()
  double gain = 0;         ///< worth of having its geometry (ask_gain.h)
  double area_px = 0;      ///< screen area that it covers
  double life_s = 0;       ///< seconds for which the geometry will serve
  bool unseen = false;     ///< the view tile shows the object too coarsely, or not at all
  bool surrounds = false;  ///< the eye is inside it: nothing is worth more
};

/// A level of geometry, or an image, that is worth asking for.
struct AssetNeed {
  AssetId id;
  double gain = 0;            ///< its worth (ask_gain.h); infinite: the eye is inside the object
  double expected_bytes = 0;  ///< bytes of the reply
  bool first = false;         ///< first geometry of an object that has none yet
};

}  // namespace mirage

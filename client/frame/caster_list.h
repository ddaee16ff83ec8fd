#pragma once
// The objects that the client draws its shadow map from.

#include <cstdint>
#include <memory>
#include <vector>

#include "client/frame/drawn_mesh.h"
#include "client/frame/resident.h"
#include "protocol/impostor/sun_frame.h"

namespace mirage {

/// An instance or group that casts the shadow of its tile.
struct DrawnCaster {
  std::uint32_t instance = 0;
  ShadowRecordPtr tile;
};

/// All casters under one sun. A list never changes: a new list means a new map.
struct CasterList {
  SunFrame frame;
  std::vector<DrawnCaster> tiles;
  std::vector<DrawnMesh> meshes;
  std::uint64_t assets = 0;  ///< number of meshes and images that had arrived by then
};
using CasterListPtr = std::shared_ptr<const CasterList>;

}  // namespace mirage

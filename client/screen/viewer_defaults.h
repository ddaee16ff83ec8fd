#pragma once
// Viewer defaults: values that a viewer uses unless options say otherwise.

#include <algorithm>

#include "client/draw/impostor_atlas.h"

namespace mirage {

inline constexpr double kSoftwareFrameMs = 50;  ///< budget of a frame on a software renderer
inline constexpr int kAtlasEdge = 1024;
/// Returns the layers of the atlas that fit into this many MB of graphics memory with all planes;
/// at least one.
inline int atlas_layers(int megabytes) {
  return std::max(1, megabytes / (kAtlasEdge * kAtlasEdge * kAtlasTexelBytes >> 20));
}

}  // namespace mirage

#pragma once
// Levels of detail of an object's geometry: what a client is told of them, and how both ends
// choose.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/impostor/capture.h"

namespace mirage {

/// One level. Level 0 is the whole mesh, each further one has fewer triangles.
struct LodInfo {
  std::uint32_t triangles = 0;
  std::uint32_t bytes = 0;  ///< on the wire
  /// Object units: how far the level's connected surfaces lie from those of the whole mesh, either
  /// way, with half a step of the quantised positions. A bound only where `spread` is 0.
  float error = 0;
  /// Object units; above 0: the level keeps a share of the foliage's pieces, enlarged to cover the
  /// same area. 95 % of the dropped pieces have a kept one within this distance: it says how far
  /// cover has moved, and bounds nothing.
  float spread = 0;
  /// Object units: the level is shaded and coloured like the whole mesh at pixels of this size and
  /// larger ones (server/lod/lod_shading.h). Its surfaces may lie right and face elsewhere.
  float shading = 0;
};

/// Cover that moves within foliage is seen less than an edge that moves: it may do so by this many
/// times tau. A still forest, FLIP at 4, 16 and 64: 0.042, 0.051, 0.076.
inline constexpr double kSpreadPerTau = 4;

/// What a level shows wrongly, in px over tau, at `px_per_unit` pixels an object unit; <= 1 is fit
/// to be drawn.
inline double lod_excess(const LodInfo& lod, double px_per_unit, double tau_px) {
  double error = lod.error > lod.spread / kSpreadPerTau ? lod.error : lod.spread / kSpreadPerTau;
  if (lod.shading > error) error = lod.shading;
  return error * px_per_unit / tau_px;
}

/// The coarsest level fit to be drawn at `px_per_unit`; 0 when none but the whole mesh is.
inline std::size_t lod_for_view(const std::vector<LodInfo>& lods, double px_per_unit,
                                double tau_px) {
  for (std::size_t i = lods.size(); i-- > 1;) {
    if (lod_excess(lods[i], px_per_unit, tau_px) <= 1) return i;
  }
  return 0;
}

/// What a tile's geometry may be off, in texels at the nearest depth the object can have.
inline constexpr double kTileErrorTexels = 0.25;
inline double allowed_tile_error(const Capture& capture) {
  return kTileErrorTexels * capture.texel_width(capture.distance - capture.radius);
}

/// The coarsest level whose error is bounded and within `allowed` object units, and which is shaded
/// like the whole mesh at texels of which that is kTileErrorTexels.
inline std::size_t lod_within(const std::vector<LodInfo>& lods, double allowed) {
  for (std::size_t i = lods.size(); i-- > 1;) {
    const bool shaded = double{lods[i].shading} * kTileErrorTexels <= allowed;
    if (lods[i].spread == 0 && double{lods[i].error} <= allowed && shaded) return i;
  }
  return 0;
}

/// The level a tile is drawn from.
inline std::size_t lod_for_tile(const std::vector<LodInfo>& lods, const Capture& capture) {
  return lod_within(lods, allowed_tile_error(capture));
}

/// Error of what lod_for_tile() chose, object units; 0: the whole mesh.
inline float tile_lod_error(const std::vector<LodInfo>& lods, const Capture& capture) {
  const std::size_t lod = lod_for_tile(lods, capture);
  return lod == 0 ? 0.0f : lods[lod].error;
}

}  // namespace mirage

#pragma once
// Levels of detail of an object's geometry: the facts sent to clients, and the choice that both
// ends make.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/impostor/capture.h"

namespace mirage {

/// One level. Level 0 is the whole mesh; each further level has fewer triangles.
struct LodInfo {
  std::uint32_t triangles = 0;
  std::uint32_t bytes = 0;  ///< on the wire
  /// Distance in object units between the level's connected surfaces and those of the whole mesh,
  /// in either direction, plus half a step of the quantised positions. It is a bound only if
  /// `spread` is 0.
  float error = 0;
  /// Object units. Above 0, the level keeps a share of the foliage's pieces, enlarged to cover the
  /// same area. 95 % of the dropped pieces have a kept one within this distance. It says how far
  /// cover moved and bounds nothing.
  float spread = 0;
  /// Object units: at pixels of this size and larger, the level is shaded and coloured like the
  /// whole mesh (server/lod/lod_shading.h). A surface may be in its place and still face elsewhere.
  float shading = 0;
};

/// Cover that moves within foliage is less visible than a moving edge, so it may move by this many
/// times tau. FLIP of a still forest at factors 4, 16 and 64: 0.042, 0.051, 0.076.
inline constexpr double kSpreadPerTau = 4;

/// Returns the visible error of a level divided by tau, at `px_per_unit` pixels an object unit. A
/// level with <= 1 may be drawn.
inline double lod_excess(const LodInfo& lod, double px_per_unit, double tau_px) {
  double error = lod.error > lod.spread / kSpreadPerTau ? lod.error : lod.spread / kSpreadPerTau;
  if (lod.shading > error) error = lod.shading;
  return error * px_per_unit / tau_px;
}

/// Returns the coarsest level that may be drawn at `px_per_unit`; 0 if only the whole mesh may.
inline std::size_t lod_for_view(const std::vector<LodInfo>& lods, double px_per_unit,
                                double tau_px) {
  for (std::size_t i = lods.size(); i-- > 1;) {
    if (lod_excess(lods[i], px_per_unit, tau_px) <= 1) return i;
  }
  return 0;
}

/// Allowed error of a tile's geometry, in texels at the nearest depth the object can have.
inline constexpr double kTileErrorTexels = 0.25;
inline double allowed_tile_error(const Capture& capture) {
  return kTileErrorTexels * capture.texel_width(capture.distance - capture.radius);
}

/// Returns the coarsest level with a bounded error within `allowed` object units. It must also be
/// shaded like the whole mesh at texels of `allowed` / kTileErrorTexels.
inline std::size_t lod_within(const std::vector<LodInfo>& lods, double allowed) {
  for (std::size_t i = lods.size(); i-- > 1;) {
    const bool shaded = double{lods[i].shading} * kTileErrorTexels <= allowed;
    if (lods[i].spread == 0 && double{lods[i].error} <= allowed && shaded) return i;
  }
  return 0;
}

/// Returns the level that a tile is drawn from.
inline std::size_t lod_for_tile(const std::vector<LodInfo>& lods, const Capture& capture) {
  return lod_within(lods, allowed_tile_error(capture));
}

/// Returns the error of the level that lod_for_tile() picks, object units; 0: the whole mesh.
inline float tile_lod_error(const std::vector<LodInfo>& lods, const Capture& capture) {
  const std::size_t lod = lod_for_tile(lods, capture);
  return lod == 0 ? 0.0f : lods[lod].error;
}

}  // namespace mirage

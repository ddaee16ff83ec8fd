#pragma once
// A view tile: the whole scene from one pose, with depth and the owner of each visible surface. It
// shows objects that have no image of their own yet.

#include <cstdint>
#include <vector>

#include "protocol/impostor/camera.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

/// Texels of colour across one cell of the other planes.
inline constexpr std::uint32_t kViewCellTexels = 2;
/// Cost of drawing a view, in tiles. Measured on a software renderer: forest 13, city 23, clutter
/// 31.
inline constexpr double kViewTiles = 20;

struct ViewTile {
  Camera camera;      ///< pose, field of view and size in texels; even edges
  double time_s = 0;  ///< of the animation, as it is shown
  /// width x height x 4, top row first: the displayed colours, sRGB; the fourth byte is 255.
  std::vector<std::uint8_t> rgba;
  /// Eye depth of the nearest and farthest surface, m; 0 < near <= far.
  double near_m = 1, far_m = 1;
  /// One code per cell, top row first: 1..255 for equal ratios of depth from far to near; 0: sky.
  std::vector<std::uint8_t> depth;
  /// Per cell: 1 + index into `instances`; 0: sky; kNobody: an instance that is not listed.
  std::vector<std::uint16_t> owners;
  std::vector<std::uint32_t> instances;  ///< the server's ids, rising

  static constexpr std::uint16_t kNobody = 0xffff;

  std::uint32_t columns() const { return camera.width / kViewCellTexels; }
  std::uint32_t rows() const { return camera.height / kViewCellTexels; }
  std::uint8_t encode_depth(double depth_m) const;
  /// Returns the nearest eye depth in m of a code 1..255. The nearest is used so that a thing lying
  /// on another is drawn in front of it, whichever of the two has its own image.
  double decode_depth(std::uint8_t code) const;
  /// Returns the largest share of a depth by which it may be drawn too near.
  double depth_step() const;
};

/// Pose of a requested view, as both ends check it against limits.h. The pose is rounded to steps,
/// so viewers standing together share a view.
struct ViewPose {
  Camera camera;
  double time_s = 0;  ///< of the animation
};

/// Returns the identity of a view in a scene under a light. Views of equal id have the same bytes.
TileId view_id(std::uint64_t revision, std::uint64_t lighting_hash, const ViewPose& pose);

}  // namespace mirage

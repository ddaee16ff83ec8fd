#pragma once
// A view tile: the whole scene from one pose, with depth and with whose surface is where. What is
// shown of objects that have no image of their own yet.

#include <cstdint>
#include <vector>

#include "protocol/impostor/camera.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

/// Colours have this many texels across one cell of the other planes.
inline constexpr std::uint32_t kViewCellTexels = 2;
/// What drawing a view takes, in tiles: forest 13, city 23, clutter 31 on a software renderer.
inline constexpr double kViewTiles = 20;

struct ViewTile {
  Camera camera;  ///< pose, field of view and size in texels; even edges
  /// width x height x 4, top row first: what a frame shows, sRGB; the fourth byte is 255.
  std::vector<std::uint8_t> rgba;
  /// Eye depth of the nearest and farthest surface, m; 0 < near <= far.
  double near_m = 1, far_m = 1;
  /// A code per cell, top row first: 1..255, equal ratios of depth from far to near; 0: sky.
  std::vector<std::uint8_t> depth;
  /// Per cell: 1 + index into `instances`, 0: sky, kNobody: of an instance that is not listed.
  std::vector<std::uint16_t> owners;
  std::vector<std::uint32_t> instances;  ///< the server's ids, rising

  static constexpr std::uint16_t kNobody = 0xffff;

  std::uint32_t columns() const { return camera.width / kViewCellTexels; }
  std::uint32_t rows() const { return camera.height / kViewCellTexels; }
  std::uint8_t encode_depth(double depth_m) const;
  /// The nearest eye depth a code of 1..255 can stand for, m: what lies on something is drawn
  /// before it, whichever of the two has an image of its own.
  double decode_depth(std::uint8_t code) const;
  /// Of a depth, by what it may be drawn too near.
  double depth_step() const;
};

/// What a view is asked for, as both ends hold it against limits.h; the pose is in steps, so that
/// those who stand together share a view.
struct ViewPose {
  Camera camera;
  double time_s = 0;  ///< of the animation
};

/// Identity of a view in a scene under a light: equal, the same bytes.
TileId view_id(std::uint64_t revision, std::uint64_t lighting_hash, const ViewPose& pose);

}  // namespace mirage

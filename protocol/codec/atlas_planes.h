#pragma once
// Atlas planes: a tile in the form that a client's textures hold it. The thread that unpacks a tile
// makes them, so that the frame only uploads.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/tile.h"

namespace mirage {

/// Each plane has a gutter of one texel, so it is (crop.w + 2) x (crop.h + 2), or empty if the tile
/// has no such plane or no content. Filtering reaches into the gutter.
struct AtlasPlanes {
  /// Both layers of a layered tile as one picture, 4 bytes a texel; the gutter is empty.
  std::vector<std::uint8_t> color;
  /// Depth codes. In tiles with colour, empty texels beside covered ones have a neighbour's code,
  /// because filtered colour reaches them.
  std::vector<std::uint8_t> depth;
  /// Normal and material, 4 bytes a texel, continued like depth.
  std::vector<std::uint8_t> surface;
  std::vector<std::uint8_t> front_color, front_depth;    ///< layered tiles: the nearer layer
  std::vector<std::uint8_t> behind_color, behind_depth;  ///< layered tiles: the other layer
  /// Light left in shadow, 0..255 for none to all; continued by some texels, then 255.
  std::vector<std::uint8_t> shadow;
};

/// Makes the planes of a decoded tile.
AtlasPlanes atlas_planes(const Tile& tile);

/// Returns the bytes of all planes of a tile with this crop and these channels.
std::size_t atlas_plane_bytes(const TileCrop& crop, std::uint8_t channels);
/// Appends all planes to `out`.
void append_atlas_planes(const AtlasPlanes& planes, std::vector<std::uint8_t>& out);
/// Reads what append_atlas_planes() has written. Error kCodec: `size` is not atlas_plane_bytes().
Result<AtlasPlanes> read_atlas_planes(const std::uint8_t* bytes, std::size_t size,
                                      const TileCrop& crop, std::uint8_t channels);

}  // namespace mirage

#pragma once
// Draws, reads back, encodes and times single tiles: for proofs and their figures, not for serving.
// GL thread only.

#include "server/render/tile_page.h"

namespace mirage {

/// A tile as read back, rows bottom first.
struct TileShot {
  std::uint32_t edge = 0;
  std::vector<std::uint8_t> color;    ///< 4 components a texel, of 1 byte or 4
  std::vector<std::uint8_t> code;     ///< depth code, 1 byte a texel
  std::vector<std::uint8_t> surface;  ///< for a relit tile, 4 bytes a texel
  std::vector<std::uint8_t> fine;     ///< depth in 24 bits, 4 bytes a texel, or empty
  double ms = 0;  ///< drawing and reading back; a software rasteriser over all cores
};

/// Cost of encoding a tile.
struct TileCost {
  double ms = 0;  ///< cutting, measuring, compressing
  std::size_t bytes = 0;
};

class TileShooter {
 public:
  /// Error kGraphicsShader.
  static Result<TileShooter> create(const GpuScene& scene, int supersample,
                                    const TileExtras& extras, bool software);

  /// Draws a lit or relit tile; nullopt if no target of this size can be made.
  std::optional<TileShot> shoot(const TileJob& job);
  const TilePageRenderer& pages() const { return pages_; }

 private:
  TileShooter(TilePageRenderer pages, const TileExtras& extras, bool software)
      : pages_(std::move(pages)), extras_(extras), software_(software) {}
  TilePageRenderer pages_;
  TileExtras extras_;
  bool software_;
};

/// Returns the number of components that differ: of colour, depth code and, if both have it,
/// surface.
std::size_t differing_components(const TileShot& a, const TileShot& b);

/// Returns the number of components of a float shot outside 0 to 1, which an 8-bit target would
/// lose.
std::size_t components_out_of_range(const TileShot& shot);

/// Encodes a shot as the product does. It must have 8-bit colour.
TileCost lean_cost(const TileShot& shot, const TileJob& job, const ObjectDescription& object);
/// Steps of the encoding to undo.
struct FullCoding {
  bool whole_window = false;
  bool fine_depth = false;  ///< if the shot has it
  bool colored = false;     ///< red and blue not as differences from green
};
TileCost full_cost(const TileShot& shot, const TileJob& job, const ObjectDescription& object,
                   const FullCoding& coding);

}  // namespace mirage

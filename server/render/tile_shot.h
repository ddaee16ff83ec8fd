#pragma once
// One tile at a time, drawn, read back and encoded at once and timed: for proofs and their figures,
// not for serving. GL thread only.

#include "server/render/tile_page.h"

namespace mirage {

/// A picture as it was read back, rows bottom first.
struct TileShot {
  std::uint32_t edge = 0;
  std::vector<std::uint8_t> color;    ///< 4 components a texel, of 1 byte or 4
  std::vector<std::uint8_t> code;     ///< depth code, 1 byte a texel
  std::vector<std::uint8_t> surface;  ///< of a relit tile, 4 bytes a texel
  std::vector<std::uint8_t> fine;     ///< depth in 24 bits, 4 bytes a texel, or empty
  double ms = 0;  ///< drawing and reading back; of a software rasteriser on all cores together
};

/// What a tile takes when it is encoded.
struct TileCost {
  double ms = 0;  ///< cutting, measuring, compressing
  std::size_t bytes = 0;
};

class TileShooter {
 public:
  /// Error kGraphicsShader.
  static Result<TileShooter> create(const GpuScene& scene, int supersample,
                                    const TileExtras& extras, bool software);

  /// nullopt when no target of this size can be made. Lit or relit tiles.
  std::optional<TileShot> shoot(const TileJob& job);
  const TileExtras& extras() const { return extras_; }
  const TilePageRenderer& pages() const { return pages_; }

 private:
  TileShooter(TilePageRenderer pages, const TileExtras& extras, bool software)
      : pages_(std::move(pages)), extras_(extras), software_(software) {}
  TilePageRenderer pages_;
  TileExtras extras_;
  bool software_;
};

/// Components that differ: of colour, depth code and, where both have it, surface.
std::size_t differing_components(const TileShot& a, const TileShot& b);

/// Components of a shot in floats that are not within 0 and 1: what an 8-bit target would lose.
std::size_t components_out_of_range(const TileShot& shot);

/// As the product encodes it. The shot has 8-bit colour.
TileCost lean_cost(const TileShot& shot, const TileJob& job, const ObjectDescription& object);
/// What of the encoding is undone.
struct FullCoding {
  bool whole_window = false;
  bool fine_depth = false;  ///< if the shot has it
  bool colored = false;     ///< red and blue as they are, not as differences from green
};
TileCost full_cost(const TileShot& shot, const TileJob& job, const ObjectDescription& object,
                   const FullCoding& coding);

}  // namespace mirage

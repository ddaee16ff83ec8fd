#pragma once
// A tile: the image of one object from one view cell, with the errors measured on it.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "protocol/impostor/error_bound.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {

/// Rectangle of content in the tile's full edge x edge window, in texels; empty if w or h is 0.
struct TileCrop {
  std::uint32_t x = 0, y = 0, w = 0, h = 0;
  std::size_t area() const { return static_cast<std::size_t>(w) * h; }
};

/// Measured on the full-precision depth of the rendered tile, in object units (see error_bound.h).
struct TileMeasure {
  /// capture depth of the quad, chosen to halve the error at the centre plane
  float plane_depth = 0;
  float depth_min = 0;  ///< nearest and farthest capture depth of the content
  float depth_max = 0;
  /// Largest Dc^2 |1/z - 1/z_drawn| over the content (error_bound.h), if drawn on the plane, on the
  /// bounding box, on the convex hull.
  float dz_quad = 0;
  float dz_cuboid = 0;
  float dz_hull = 0;
  float depth_gap = 0;  ///< largest depth step between neighbours: the widest possible hole
  /// Largest Dc^2 |1/z - 1/z_behind| over blended surfaces: how far behind its stored depth a texel
  /// still shows something. 0: nothing shows through.
  float dz_behind = 0;
  float lod_error = 0;  ///< distance between its geometry and the whole mesh
};

/// Decoded tile, content crop only, rows top to bottom (row 0 = up side of the capture basis).
struct Tile {
  std::uint32_t edge = 0;  ///< texels over the full window
  TileCrop crop;
  TileMeasure measure;
  std::uint8_t channels = kLitTile;
  /// crop.w*crop.h*4; premultiplied linear light (relit: base colour), sRGB-encoded.
  std::vector<std::uint8_t> rgba;
  /// Relit tiles only, crop.w*crop.h*4. Bytes 0 and 1: the normal as octahedral x, y about the axis
  /// towards the capture eye (0..255 is -1..1). Byte 2: roughness. Byte 3, low half: occlusion, of
  /// 15. Byte 3, high half: 8..15 is metallic in eighths. 0..7 is not metallic, and says how much
  /// the texel's normals differ: 1 less the length of their mean, in sevenths. The seams of the
  /// octahedral map lie where no visible surface points, so the plane may be filtered.
  std::vector<std::uint8_t> surface;
  std::vector<std::uint8_t> depth;  ///< crop.w*crop.h; hyperbolic 1..255 over Dc -+ r, 0 = nothing
  /// Layered tiles only, colour and depth in the formats above: the surface more than kLayerStep
  /// codes behind `depth`, whether `rgba` covers it or not. `rgba` then holds only the nearer
  /// surface, and `rgba` over `behind` is the picture of a lit tile. Colours are in steps of
  /// kBehindStep.
  std::vector<std::uint8_t> behind, behind_depth;
  /// Shadow tiles only, crop.w*crop.h: the share of the texel's light (luminance, with the sun)
  /// that is left in shadow, 1..255 for none to all; 0: nothing there.
  std::vector<std::uint8_t> shadow;

  bool relit() const { return channels == kRelitTile; }
  bool layered() const { return channels == kLayeredTile; }
};

/// Depth codes. From 2 to 8 the reference tree looks the same from the side; 16 loses 0.7 dB.
inline constexpr int kLayerStep = 8;
/// Colour step of the layer behind, of 256. It saves a quarter of the layer's bytes and loses less
/// than 0.1 dB.
inline constexpr int kBehindStep = 8;

/// Returns half the tangent of the capture window: the bounding sphere's cone plus a guard of 1
/// texel a side.
double capture_half_tangent(double radius, double distance, std::uint32_t edge);

/// Hyperbolic 8-bit depth over [Dc - r, Dc + r] (object units).
struct DepthCode {
  double near_depth = 0;
  double far_depth = 0;
  DepthCode(double radius, double distance);
  /// Returns the code, 1..255, of a depth clamped to the range.
  std::uint8_t encode(double depth) const;
  double decode(std::uint8_t code) const;
  /// Returns the largest |z - decode(encode(z))| over the range (half a step at the far end).
  double quantum() const;
  /// Returns the largest |1/z - 1/decode(encode(z))|. It is the same everywhere: the code is linear
  /// in 1 / z.
  double inverse_quantum() const;
};

}  // namespace mirage

#pragma once
// Geometric error (E1): the true error in pixels of what was drawn, from the reference frame's
// depth. It is compared with the bound that every impostor was drawn with.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mirage {

struct PlannedFrame;
struct ReferenceFrame;

struct GeometricError {
  std::vector<float> errors_px;  ///< one per compared pixel
  /// Bound over the largest error among an impostor's pixels, because the bound limits the largest
  /// error. One for each drawn impostor with at least kRatioPixels compared pixels and an error of
  /// at least 0.01 px.
  std::vector<float> ratios;
  std::uint64_t violations = 0;  ///< pixels whose error exceeds their impostor's bound
  std::uint64_t compared = 0;
  std::uint64_t disoccluded = 0;  ///< pixels that show a part of an object its tile never saw
  std::uint64_t holes = 0;        ///< pixels of objects without any image
  std::uint64_t viewed = 0;       ///< pixels of objects shown by the view tile alone
  std::uint64_t object_pixels = 0;
  double worst_excess_px = 0;
};

inline constexpr std::uint64_t kRatioPixels = 16;

/// Adds the error of every pixel of the reference that shows an impostor's object. Its surface
/// point P is on a capture ray of the tile, and Q is where the tile's method draws that ray. The
/// error is the distance between the images of P and Q. `offset_px` is where in the pixel the
/// reference sampled depth.
void add_geometric_error(const ReferenceFrame& reference, double offset_px,
                         const PlannedFrame& frame, GeometricError& out);

}  // namespace mirage

#pragma once
// LDR-FLIP: the difference between two images as seen when they alternate. Source: P. Andersson, J.
// Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. D. Fairchild, "FLIP: A Difference
// Evaluator for Alternating Images", HPG 2020; constants of version 1.6.

#include <optional>
#include <vector>

#include "protocol/quality/image_view.h"

namespace mirage {

/// Pixels per degree of a 0.7 m wide monitor of 3840 px seen from 0.7 m: 0.7 * 3840 / 0.7 * pi /
/// 180. Printed next to every FLIP figure.
inline constexpr double kFlipPixelsPerDegree = 67.0206432;

struct FlipMap {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<float> error;  ///< per pixel, 0 (no difference) to 1
};

/// Returns the FLIP of each pixel's RGB; alpha is ignored. nullopt if the sizes differ, if an image
/// is empty, or if `pixels_per_degree` is not positive and finite.
std::optional<FlipMap> flip_map(const ImageView& reference, const ImageView& test,
                                double pixels_per_degree = kFlipPixelsPerDegree);

/// Return the mean over all pixels or over a mask; nullopt ("n/a") if it is empty or the sizes
/// differ.
std::optional<double> flip_mean(const FlipMap& map);
std::optional<double> flip_mean(const FlipMap& map, const Mask& mask);
/// Returns the largest value over a mask; nullopt as above.
std::optional<double> flip_max(const FlipMap& map, const Mask& mask);

/// Returns the value that a share `q` (0 to 1) of the mask's pixels stays within; nullopt as above.
/// A mean hides a small thing that looks wrong, the 99th percentile shows it.
std::optional<double> flip_quantile(const FlipMap& map, const Mask& mask, double q);

/// A square of a picture. Its middle is given in shares of width and height, right and down.
struct PicturePlace {
  double x = 0, y = 0;
  double flip = 0;  ///< mean over the square
};
/// Returns the square with an edge of `edge` px, or of the picture where that is smaller, that has
/// the largest mean; nullopt: the map is empty, or `edge` is 0.
std::optional<PicturePlace> flip_worst_place(const FlipMap& map, std::uint32_t edge);

/// Returns the map as RGBA8 in five colours of "magma" (matplotlib), black for 0 to light yellow
/// for kMostFlip and more.
std::vector<std::uint8_t> heat_map(const FlipMap& map);
inline constexpr float kMostFlip = 0.5f;  ///< larger errors look alike

/// Weighted quartiles, as FLIP's tools print them. Each pixel counts with its own error, so half of
/// the total error lies in pixels with an error of at most `median`.
struct FlipQuartiles {
  double first = 0, median = 0, third = 0;
};
/// Returns the quartiles; nullopt if the mask is empty, all zero if there is no error.
std::optional<FlipQuartiles> flip_quartiles(const FlipMap& map, const Mask& mask);

}  // namespace mirage

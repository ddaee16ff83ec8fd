#pragma once
// Reduces an image while it is decoded, row by row. An image too large for the scene's budget is
// thus never in memory as a whole.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/model/model.h"

namespace mirage::gltf {

/// A box filter over whole source pixels; each counts in one result pixel. Colours are averaged as
/// light (IEC 61966-2-1), data and alpha as they are.
class ImageReducer {
 public:
  /// Each side of the result is halved (rounded down, at least 1) `halvings` times. `channels` of
  /// the source: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA.
  ImageReducer(std::uint32_t width, std::uint32_t height, int channels, int halvings, bool srgb);

  /// Takes the next rows of the source, any number of whole ones.
  void add_rows(std::span<const std::uint8_t> rows);
  /// Returns the result as RGBA8, after all rows.
  Image take();

 private:
  void add_row(const std::uint8_t* row);
  void finish_row();

  std::uint32_t width_, height_;
  int channels_;
  bool srgb_;
  Image out_;
  std::uint32_t row_ = 0;  ///< next row of the source
  std::uint32_t out_row_ = 0;
  std::vector<float> sums_;  ///< of the present result row, 4 per pixel
};

/// Returns a side after so many halvings.
inline std::uint32_t halved(std::uint32_t side, int halvings) {
  return std::max(1u, side >> halvings);
}

}  // namespace mirage::gltf

#pragma once
// Makes an image smaller while it is decoded, row by row: what is too large for the scene's budget
// never lies in memory whole.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/model/model.h"

namespace mirage::gltf {

/// Box filter over whole source pixels, each of which counts in one result pixel. Colours are
/// averaged as light (IEC 61966-2-1), data and alpha as they are.
class ImageReducer {
 public:
  /// The result has each side halved (rounded down, at least 1) `halvings` times. `channels` of
  /// the source: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA.
  ImageReducer(std::uint32_t width, std::uint32_t height, int channels, int halvings, bool srgb);

  /// Takes the next rows of the source, any number of whole ones.
  void add_rows(std::span<const std::uint8_t> rows);
  /// After all rows: RGBA8.
  Image take();

 private:
  void add_row(const std::uint8_t* row);
  void finish_row();

  std::uint32_t width_, height_;
  int channels_;
  bool srgb_;
  Image out_;
  std::uint32_t row_ = 0;  ///< next of the source
  std::uint32_t out_row_ = 0;
  std::vector<float> sums_;  ///< of the result row in work, 4 a pixel
};

/// A side after so many halvings.
inline std::uint32_t halved(std::uint32_t side, int halvings) {
  return std::max(1u, side >> halvings);
}

}  // namespace mirage::gltf

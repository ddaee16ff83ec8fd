#pragma once
#include <cstdint>

namespace mirage {

/// Rows of a picture, counted from the bottom: low … high - 1.
struct RowBand {
  std::uint32_t low = 0, high = 0;
  std::uint32_t rows() const { return high - low; }
};

/// Samples whose shading costs about as much as a triangle, on a software renderer.
inline constexpr double kSamplesPerTriangle = 10;

}  // namespace mirage

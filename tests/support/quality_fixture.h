#pragma once
// Owned test images and simple pictures for the image measures.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "protocol/quality/image_view.h"

namespace mirage::test {

struct TestImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;

  TestImage(std::uint32_t w, std::uint32_t h, std::uint8_t grey = 0, std::uint8_t alpha = 0)
      : width(w), height(h), rgba(static_cast<std::size_t>(w) * h * 4, grey) {
    for (std::size_t i = 3; i < rgba.size(); i += 4) rgba[i] = alpha;
  }
  ImageView view() const { return {width, height, rgba.data()}; }
  void set(std::size_t x, std::size_t y, std::uint8_t grey, std::uint8_t alpha) {
    std::uint8_t* p = rgba.data() + (y * width + x) * 4;
    p[0] = p[1] = p[2] = grey;
    p[3] = alpha;
  }
};

/// Antialiased disc with stripes over grey 128; coverage by distance to the edge.
inline TestImage disc_image(std::uint32_t size, double center_x, double center_y, double radius) {
  TestImage image(size, size, 128, 0);
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      const double dx = x + 0.5 - center_x, dy = y + 0.5 - center_y;
      const double cover = std::clamp(radius - std::hypot(dx, dy) + 0.5, 0.0, 1.0);
      if (cover <= 0) continue;
      const double shade = 128 + 100 * std::sin(dx * 0.9) * std::cos(dy * 0.7);
      image.set(x, y, static_cast<std::uint8_t>(std::lround(128 + cover * (shade - 128))),
                static_cast<std::uint8_t>(std::lround(255 * cover)));
    }
  }
  return image;
}

}  // namespace mirage::test

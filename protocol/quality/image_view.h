#pragma once
// Image view: images and masks for the measures of numerics.md section 1.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace mirage {

/// Non-owning view of an image: 8-bit RGBA, rows top to bottom without padding. RGB is what the
/// viewer shows, sRGB-encoded and already composited over its background. Alpha is the coverage
/// that the object had before compositing; only masks and coverage measures use it.
struct ImageView {
  std::uint32_t width = 0;   ///< px
  std::uint32_t height = 0;  ///< px
  const std::uint8_t* rgba = nullptr;

  std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
  const std::uint8_t* pixel(std::size_t x, std::size_t y) const {
    return rgba + (y * width + x) * 4;
  }
};

/// True if two views can be compared: same size, pixels present.
bool comparable(const ImageView& reference, const ImageView& test);

/// Half-open box in px.
struct PixelBox {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// A set of pixels of an image.
struct Mask {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> inside;  ///< width * height; 1 inside, 0 outside

  bool at(std::size_t x, std::size_t y) const { return inside[y * width + x] != 0; }
  /// Returns the size of the mask in px, to be printed next to every figure measured on it.
  std::size_t count() const;
  bool fits(const ImageView& image) const {
    return width == image.width && height == image.height && inside.size() == image.pixels();
  }
};

/// Returns a mask of every pixel of an image of this size.
Mask full_mask(std::uint32_t width, std::uint32_t height);

/// Returns the pixels where either image has alpha >= `min_alpha`, grown by `grow_px` in the
/// maximum norm (a square of edge 2 grow_px + 1). The defaults give the mask of every measure of
/// numerics.md section 1: (alpha of reference > 0) union (alpha of test > 0), grown by 2 px. It is
/// empty (0 x 0) if the images cannot be compared.
Mask union_mask(const ImageView& reference, const ImageView& test, int min_alpha = 1,
                int grow_px = 2);

/// Returns the smallest box around the mask; nullopt if it is empty.
std::optional<PixelBox> bounding_box(const Mask& mask);

/// Returns a mask of the pixels of a box.
Mask box_mask(std::uint32_t width, std::uint32_t height, const PixelBox& box);

}  // namespace mirage

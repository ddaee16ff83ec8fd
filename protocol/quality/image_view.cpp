#include "protocol/quality/image_view.h"

#include <algorithm>

namespace mirage {
namespace {

// Grows along one axis: a set pixel reaches `grow` pixels to both sides along its line.
void grow_lines(const std::vector<std::uint8_t>& in, std::vector<std::uint8_t>& out,
                std::size_t lines, std::size_t line_step, std::size_t length, std::size_t step,
                std::size_t grow) {
  for (std::size_t line = 0; line < lines; ++line) {
    const std::size_t base = line * line_step;
    for (std::size_t i = 0; i < length; ++i) {
      if (in[base + i * step] == 0) continue;
      const std::size_t first = i > grow ? i - grow : 0;
      const std::size_t last = std::min(length - 1, i + grow);
      for (std::size_t k = first; k <= last; ++k) out[base + k * step] = 1;
    }
  }
}

}  // namespace

bool comparable(const ImageView& reference, const ImageView& test) {
  return reference.rgba != nullptr && test.rgba != nullptr && reference.width == test.width &&
         reference.height == test.height;
}

std::size_t Mask::count() const {
  return static_cast<std::size_t>(std::count(inside.begin(), inside.end(), std::uint8_t{1}));
}

Mask full_mask(std::uint32_t width, std::uint32_t height) {
  return {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height, 1)};
}

Mask union_mask(const ImageView& reference, const ImageView& test, int min_alpha, int grow_px) {
  if (!comparable(reference, test)) return {};
  const std::size_t width = reference.width, height = reference.height;
  Mask mask{reference.width, reference.height, std::vector<std::uint8_t>(width * height, 0)};
  for (std::size_t i = 0; i < mask.inside.size(); ++i) {
    const int alpha = std::max(reference.rgba[i * 4 + 3], test.rgba[i * 4 + 3]);
    mask.inside[i] = alpha >= min_alpha ? 1 : 0;
  }
  if (grow_px <= 0) return mask;
  const auto grow = static_cast<std::size_t>(grow_px);
  std::vector<std::uint8_t> wide(mask.inside.size(), 0);
  grow_lines(mask.inside, wide, height, width, width, 1, grow);
  std::fill(mask.inside.begin(), mask.inside.end(), std::uint8_t{0});
  grow_lines(wide, mask.inside, width, 1, height, width, grow);
  return mask;
}

std::optional<PixelBox> bounding_box(const Mask& mask) {
  PixelBox box{mask.width, mask.height, 0, 0};
  for (std::uint32_t y = 0; y < mask.height; ++y) {
    for (std::uint32_t x = 0; x < mask.width; ++x) {
      if (!mask.at(x, y)) continue;
      box.x0 = std::min(box.x0, x);
      box.y0 = std::min(box.y0, y);
      box.x1 = std::max(box.x1, x + 1);
      box.y1 = std::max(box.y1, y + 1);
    }
  }
  if (box.x1 == 0) return std::nullopt;
  return box;
}

Mask box_mask(std::uint32_t width, std::uint32_t height, const PixelBox& box) {
  Mask mask{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height, 0)};
  for (std::size_t y = box.y0; y < std::min(box.y1, height); ++y) {
    for (std::size_t x = box.x0; x < std::min(box.x1, width); ++x) mask.inside[y * width + x] = 1;
  }
  return mask;
}

}  // namespace mirage

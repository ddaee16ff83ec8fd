#include <algorithm>
#include <cstring>

#define STB_DXT_IMPLEMENTATION
#define STB_DXT_STATIC
#include <stb/stb_dxt.h>

#include "protocol/color_codec.h"

namespace mirage {
namespace {

constexpr std::uint32_t kEdge = 4;  // texels of a block
constexpr std::size_t kHalf = 4;    // bytes of its end points, and of its indices

std::size_t blocks(std::uint32_t texels) { return (texels + kEdge - 1) / kEdge; }

// 5, 6 or 5 bits widened to 8 by repeating the highest.
void color_of(unsigned bits, int out[3]) {
  const unsigned r = bits >> 11 & 31, g = bits >> 5 & 63, b = bits & 31;
  out[0] = static_cast<int>(r << 3 | r >> 2);
  out[1] = static_cast<int>(g << 2 | g >> 4);
  out[2] = static_cast<int>(b << 3 | b >> 2);
}

// The four colours of a block; BC3 knows no other mode of its colour half.
void palette_of(const std::uint8_t* ends, std::uint8_t palette[4][3]) {
  int a[3], b[3];
  color_of(ends[0] | unsigned{ends[1]} << 8, a);
  color_of(ends[2] | unsigned{ends[3]} << 8, b);
  for (int k = 0; k < 3; ++k) {
    palette[0][k] = static_cast<std::uint8_t>(a[k]);
    palette[1][k] = static_cast<std::uint8_t>(b[k]);
    palette[2][k] = static_cast<std::uint8_t>((2 * a[k] + b[k]) / 3);
    palette[3][k] = static_cast<std::uint8_t>((a[k] + 2 * b[k]) / 3);
  }
}

}  // namespace

ColorBytes encode_bc_colors(const ColorBytes& colors, std::uint32_t w, std::uint32_t h) {
  const std::size_t count = blocks(w) * blocks(h);
  ColorBytes split(count * 2 * kHalf);
  std::size_t n = 0;
  for (std::uint32_t y = 0; y < h; y += kEdge) {
    for (std::uint32_t x = 0; x < w; x += kEdge, ++n) {
      std::uint8_t texels[kEdge * kEdge * 4], block[2 * kHalf];
      for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
        const std::size_t from =
            std::size_t{std::min(y + i / kEdge, h - 1)} * w + std::min(x + i % kEdge, w - 1);
        std::copy_n(&colors[from * 4], 4, &texels[i * 4]);
      }
      stb_compress_dxt_block(block, texels, 0, STB_DXT_NORMAL);
      std::copy_n(block, kHalf, &split[n * kHalf]);
      std::copy_n(block + kHalf, kHalf, &split[(count + n) * kHalf]);
    }
  }
  return compress_block(split.data(), split.size());
}

Result<ColorBytes> decode_bc_colors(const std::uint8_t* bytes, std::size_t size, std::uint32_t w,
                                    std::uint32_t h) {
  const std::size_t count = blocks(w) * blocks(h);
  const Result<ColorBytes> split = decompress_block(bytes, size, count * 2 * kHalf);
  if (!split) return split.error();
  ColorBytes out(std::size_t{w} * h * 4);
  std::size_t n = 0;
  for (std::uint32_t y = 0; y < h; y += kEdge) {
    for (std::uint32_t x = 0; x < w; x += kEdge, ++n) {
      std::uint8_t palette[4][3];
      palette_of(&(*split)[n * kHalf], palette);
      const std::uint8_t* indices = &(*split)[(count + n) * kHalf];
      for (std::uint32_t ty = y; ty < std::min(y + kEdge, h); ++ty) {
        for (std::uint32_t tx = x; tx < std::min(x + kEdge, w); ++tx) {
          const unsigned index = indices[ty - y] >> 2 * (tx - x) & 3;
          std::uint8_t* to = &out[(std::size_t{ty} * w + tx) * 4];
          std::copy_n(palette[index], 3, to);
          to[3] = 255;
        }
      }
    }
  }
  return out;
}

}  // namespace mirage

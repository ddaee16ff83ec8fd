#include "protocol/codec/tile_color.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mirage {
namespace {

constexpr int kEncodeSteps = 4096;  // finer than 1/255 of sRGB except in its darkest three values

double linear_from_srgb(double s) {
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

struct Curves {
  std::array<float, 256> linear{};                    // of an sRGB byte, 0..1
  std::array<std::uint8_t, kEncodeSteps + 1> srgb{};  // of linear * kEncodeSteps
  Curves() {
    for (std::size_t i = 0; i < linear.size(); ++i) {
      linear[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
    }
    for (std::size_t i = 0; i < srgb.size(); ++i) {
      const double v = static_cast<double>(i) / kEncodeSteps;
      const double s = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
      srgb[i] = static_cast<std::uint8_t>(std::lround(255 * s));
    }
  }
  // The byte of `factor` times the light of `byte`, at most white.
  std::uint8_t scaled(std::uint8_t byte, float factor) const { return sum(0, byte, factor); }
  // The byte of the light of `byte` plus `factor` times the light of `other`, at most white.
  std::uint8_t sum(std::uint8_t byte, std::uint8_t other, float factor) const {
    const float v = std::min(linear[byte] + linear[other] * factor, 1.0f);
    return srgb[static_cast<std::size_t>(v * kEncodeSteps + 0.5f)];
  }
};

const Curves& curves() {
  static const Curves all;
  return all;
}

// One level of the pyramid: mean colours of covered texels.
struct Level {
  std::uint32_t w = 0, h = 0;
  std::vector<std::uint8_t> texels;  // w x h x 4; fourth byte 0: not filled yet
  std::uint8_t* at(std::uint32_t x, std::uint32_t y) {
    return &texels[(std::size_t{y} * w + x) * 4];
  }
};

Level halved(Level& fine) {
  Level out{(fine.w + 1) / 2, (fine.h + 1) / 2, {}};
  out.texels.resize(std::size_t{out.w} * out.h * 4);
  for (std::uint32_t y = 0; y < out.h; ++y) {
    for (std::uint32_t x = 0; x < out.w; ++x) {
      unsigned sum[3] = {}, count = 0;
      for (std::uint32_t fy = 2 * y; fy < std::min(2 * y + 2, fine.h); ++fy) {
        for (std::uint32_t fx = 2 * x; fx < std::min(2 * x + 2, fine.w); ++fx) {
          const std::uint8_t* from = fine.at(fx, fy);
          if (from[3] == 0) continue;
          for (int k = 0; k < 3; ++k) sum[k] += from[k];
          ++count;
        }
      }
      if (count == 0) continue;
      std::uint8_t* to = out.at(x, y);
      for (int k = 0; k < 3; ++k) to[k] = static_cast<std::uint8_t>((sum[k] + count / 2) / count);
      to[3] = 255;
    }
  }
  return out;
}

bool has_gaps(const Level& level) {
  for (std::size_t i = 3; i < level.texels.size(); i += 4) {
    if (level.texels[i] == 0) return true;
  }
  return false;
}

void fill_gaps(Level& fine, Level& coarse) {
  for (std::uint32_t y = 0; y < fine.h; ++y) {
    for (std::uint32_t x = 0; x < fine.w; ++x) {
      std::uint8_t* to = fine.at(x, y);
      if (to[3] == 0) std::copy_n(coarse.at(x / 2, y / 2), 4, to);
    }
  }
}

}  // namespace

std::vector<std::uint8_t> straight_colors(const std::vector<std::uint8_t>& rgba, std::uint32_t w,
                                          std::uint32_t h) {
  std::vector<Level> levels;
  levels.push_back({w, h, rgba});
  for (std::uint8_t *p = levels[0].texels.data(), *end = p + rgba.size(); p != end; p += 4) {
    if (p[3] == 0 || p[3] == 255) continue;
    const float factor = 255.0f / p[3];
    for (int k = 0; k < 3; ++k) p[k] = curves().scaled(p[k], factor);
    p[3] = 255;
  }
  while (has_gaps(levels.back()) && std::max(levels.back().w, levels.back().h) > 1) {
    levels.push_back(halved(levels.back()));
  }
  for (std::size_t i = levels.size(); i-- > 1;) fill_gaps(levels[i - 1], levels[i]);
  return std::move(levels[0].texels);
}

void premultiply_colors(const std::vector<std::uint8_t>& straight,
                        std::vector<std::uint8_t>& rgba) {
  for (std::size_t i = 0; i + 4 <= rgba.size(); i += 4) {
    const std::uint8_t alpha = rgba[i + 3];
    const float factor = static_cast<float>(alpha) / 255.0f;
    for (std::size_t k = i; k < i + 3; ++k) {
      rgba[k] = alpha == 255 ? straight[k] : alpha == 0 ? 0 : curves().scaled(straight[k], factor);
    }
  }
}

std::vector<std::uint8_t> front_over_behind(const std::vector<std::uint8_t>& front,
                                            const std::vector<std::uint8_t>& behind) {
  std::vector<std::uint8_t> out = front;
  for (std::size_t i = 0; i + 4 <= out.size(); i += 4) {
    if (front[i + 3] == 255 || behind[i + 3] == 0) continue;
    const float open = 1.0f - static_cast<float>(front[i + 3]) / 255.0f;
    for (std::size_t k = i; k < i + 3; ++k) out[k] = curves().sum(front[k], behind[k], open);
    const float cover = static_cast<float>(behind[i + 3]) * open;
    out[i + 3] = static_cast<std::uint8_t>(static_cast<float>(front[i + 3]) + cover + 0.5f);
  }
  return out;
}

ColorError color_error(const std::vector<std::uint8_t>& original,
                       const std::vector<std::uint8_t>& decoded) {
  std::uint64_t squares = 0, count = 0;
  int worst = 0;
  for (std::size_t i = 0; i + 4 <= original.size(); i += 4) {
    if (original[i + 3] == 0) continue;
    for (std::size_t k = i; k < i + 3; ++k) {
      const int d = std::abs(int{original[k]} - int{decoded[k]});
      squares += static_cast<std::uint64_t>(d * d);
      worst = std::max(worst, d);
    }
    count += 3;
  }
  ColorError out;
  if (count > 0) {
    out.rms =
        static_cast<float>(std::sqrt(static_cast<double>(squares) / static_cast<double>(count)));
  }
  out.max = static_cast<std::uint8_t>(worst);
  return out;
}

}  // namespace mirage

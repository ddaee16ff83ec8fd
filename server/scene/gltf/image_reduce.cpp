#include "server/scene/gltf/image_reduce.h"

#include <array>
#include <cmath>

namespace mirage::gltf {
namespace {

constexpr std::size_t kSteps = 65536;  // 1/255 of sRGB is 20 of them where it is darkest

float light_of(float code) {
  return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
}

float code_of(float light) {
  return light <= 0.0031308f ? light * 12.92f : 1.055f * std::pow(light, 1 / 2.4f) - 0.055f;
}

using FromByte = std::array<float, 256>;
using ToByte = std::vector<std::uint8_t>;

FromByte make_from_byte(bool srgb) {
  FromByte table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float code = static_cast<float>(i) / 255.0f;
    table[i] = srgb ? light_of(code) : code;
  }
  return table;
}

ToByte make_to_byte(bool srgb) {
  ToByte table(kSteps);
  for (std::size_t i = 0; i < kSteps; ++i) {
    const float value = static_cast<float>(i) / (kSteps - 1);
    table[i] = static_cast<std::uint8_t>((srgb ? code_of(value) : value) * 255.0f + 0.5f);
  }
  return table;
}

const FromByte& from_byte(bool srgb) {
  static const FromByte kLight = make_from_byte(true);
  static const FromByte kPlain = make_from_byte(false);
  return srgb ? kLight : kPlain;
}

const ToByte& to_byte(bool srgb) {
  static const ToByte kCode = make_to_byte(true);
  static const ToByte kPlain = make_to_byte(false);
  return srgb ? kCode : kPlain;
}

/// First source pixel of result pixel `i`.
std::uint32_t first_of(std::uint32_t i, std::uint32_t from, std::uint32_t to) {
  return static_cast<std::uint32_t>(std::uint64_t{i} * from / to);
}

}  // namespace

ImageReducer::ImageReducer(std::uint32_t width, std::uint32_t height, int channels, int halvings,
                           bool srgb)
    : width_(width), height_(height), channels_(channels), srgb_(srgb) {
  out_.width = halved(width, halvings);
  out_.height = halved(height, halvings);
  out_.srgb = srgb;
  out_.rgba.resize(std::size_t{out_.width} * out_.height * 4);
  sums_.assign(std::size_t{out_.width} * 4, 0.0f);
}

void ImageReducer::add_rows(std::span<const std::uint8_t> rows) {
  const std::size_t stride = std::size_t{width_} * static_cast<std::size_t>(channels_);
  for (std::size_t at = 0; at + stride <= rows.size() && row_ < height_; at += stride) {
    add_row(&rows[at]);
    ++row_;
    if (row_ == first_of(out_row_ + 1, height_, out_.height)) finish_row();
  }
}

void ImageReducer::add_row(const std::uint8_t* row) {
  const FromByte& color = from_byte(srgb_);
  const FromByte& plain = from_byte(false);
  const int step = channels_;
  const int green = step < 3 ? 0 : 1;
  const int blue = step < 3 ? 0 : 2;
  const bool has_alpha = step == 2 || step == 4;
  for (std::uint32_t x = 0; x < out_.width; ++x) {
    float* sum = &sums_[std::size_t{x} * 4];
    const std::uint32_t end = first_of(x + 1, width_, out_.width);
    for (std::uint32_t s = first_of(x, width_, out_.width); s < end; ++s, row += step) {
      sum[0] += color[row[0]];
      sum[1] += color[row[green]];
      sum[2] += color[row[blue]];
      sum[3] += has_alpha ? plain[row[step - 1]] : 1.0f;
    }
  }
}

void ImageReducer::finish_row() {
  const ToByte& color = to_byte(srgb_);
  const ToByte& plain = to_byte(false);
  const std::uint32_t rows = row_ - first_of(out_row_, height_, out_.height);
  std::uint8_t* out = &out_.rgba[std::size_t{out_row_} * out_.width * 4];
  for (std::uint32_t x = 0; x < out_.width; ++x) {
    const std::uint32_t columns =
        first_of(x + 1, width_, out_.width) - first_of(x, width_, out_.width);
    const float scale = (kSteps - 1) / static_cast<float>(rows * columns);
    for (std::size_t c = 0; c < 4; ++c) {
      const float level = sums_[std::size_t{x} * 4 + c] * scale + 0.5f;
      const auto step = std::min(static_cast<std::size_t>(level), kSteps - 1);
      *out++ = c < 3 ? color[step] : plain[step];
    }
  }
  std::fill(sums_.begin(), sums_.end(), 0.0f);
  ++out_row_;
}

Image ImageReducer::take() { return std::move(out_); }

}  // namespace mirage::gltf

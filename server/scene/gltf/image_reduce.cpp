#include "server/scene/gltf/image_reduce.h"

#include "server/scene/gltf/srgb_table.h"

namespace mirage::gltf {
namespace {

/// Returns the first source pixel of result pixel `i`.
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
  const std::array<float, 256>& color = from_byte(srgb_);
  const std::array<float, 256>& plain = from_byte(false);
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
  const std::vector<std::uint8_t>& color = to_byte(srgb_);
  const std::vector<std::uint8_t>& plain = to_byte(false);
  const std::uint32_t rows = row_ - first_of(out_row_, height_, out_.height);
  std::uint8_t* out = &out_.rgba[std::size_t{out_row_} * out_.width * 4];
  for (std::uint32_t x = 0; x < out_.width; ++x) {
    const std::uint32_t columns =
        first_of(x + 1, width_, out_.width) - first_of(x, width_, out_.width);
    const float share = 1 / static_cast<float>(rows * columns);
    for (std::size_t c = 0; c < 4; ++c) {
      *out++ = byte_of(sums_[std::size_t{x} * 4 + c] * share, c < 3 ? color : plain);
    }
  }
  std::fill(sums_.begin(), sums_.end(), 0.0f);
  ++out_row_;
}

Image ImageReducer::take() { return std::move(out_); }

}  // namespace mirage::gltf

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "protocol/quality/metrics.h"

namespace mirage {
namespace {

constexpr double kC1 = 0.01 * 255.0 * 0.01 * 255.0;
constexpr double kC2 = 0.03 * 255.0 * 0.03 * 255.0;
constexpr int kRadius = 5;  // 11x11
constexpr double kSigma = 1.5;
constexpr std::uint32_t kWindow = 8;
constexpr std::uint32_t kStride = 4;

double luma(const std::uint8_t* p) { return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2]; }

/// Weighted means over a window: a, b, a^2, b^2, ab.
using Moments = std::array<double, 5>;

Moments moments_of(double a, double b) { return {a, b, a * a, b * b, a * b}; }

void add(Moments& sum, const Moments& m, double weight) {
  for (std::size_t i = 0; i < m.size(); ++i) sum[i] += weight * m[i];
}

double index_from(const Moments& m) {
  const double variance_a = m[2] - m[0] * m[0], variance_b = m[3] - m[1] * m[1];
  const double covariance = m[4] - m[0] * m[1];
  return (2.0 * m[0] * m[1] + kC1) * (2.0 * covariance + kC2) /
         ((m[0] * m[0] + m[1] * m[1] + kC1) * (variance_a + variance_b + kC2));
}

/// Returns Gaussian means along one line of moments; weights outside the line are left out.
Moments blurred(const Moments* line, std::size_t step, int at, int length,
                const std::array<double, 2 * kRadius + 1>& taps) {
  Moments sum{};
  double weight = 0;
  for (int k = -kRadius; k <= kRadius; ++k) {
    if (at + k < 0 || at + k >= length) continue;
    const double w = taps[static_cast<std::size_t>(k + kRadius)];
    add(sum, line[static_cast<std::size_t>(at + k) * step], w);
    weight += w;
  }
  for (double& s : sum) s /= weight;
  return sum;
}

std::array<double, 2 * kRadius + 1> gaussian_taps() {
  std::array<double, 2 * kRadius + 1> taps{};
  for (int k = -kRadius; k <= kRadius; ++k) {
    taps[static_cast<std::size_t>(k + kRadius)] = std::exp(-k * k / (2.0 * kSigma * kSigma));
  }
  return taps;
}

/// Returns the index of the flat window [x0, x1) x [y0, y1).
double window_index(const ImageView& a, const ImageView& b, const PixelBox& w) {
  Moments sum{};
  const double weight = 1.0 / (static_cast<double>(w.x1 - w.x0) * (w.y1 - w.y0));
  for (std::uint32_t y = w.y0; y < w.y1; ++y) {
    for (std::uint32_t x = w.x0; x < w.x1; ++x) {
      add(sum, moments_of(luma(a.pixel(x, y)), luma(b.pixel(x, y))), weight);
    }
  }
  return index_from(sum);
}

}  // namespace

std::optional<double> ssim(const ImageView& reference, const ImageView& test, const Mask& mask) {
  if (!comparable(reference, test) || !mask.fits(reference)) return std::nullopt;
  const std::optional<PixelBox> box = bounding_box(mask);
  if (!box) return std::nullopt;
  static const std::array<double, 2 * kRadius + 1> kTaps = gaussian_taps();
  const int width = static_cast<int>(reference.width), height = static_cast<int>(reference.height);
  // Works only on rows and columns that windows of the mask's box touch.
  const int top = std::max(static_cast<int>(box->y0) - kRadius, 0);
  const int bottom = std::min(static_cast<int>(box->y1) + kRadius, height);
  std::vector<Moments> line(reference.width);
  std::vector<Moments> rows(static_cast<std::size_t>(bottom - top) * reference.width);
  for (int y = top; y < bottom; ++y) {
    for (int x = 0; x < width; ++x) {
      line[static_cast<std::size_t>(x)] = moments_of(
          luma(reference.pixel(static_cast<std::size_t>(x), static_cast<std::size_t>(y))),
          luma(test.pixel(static_cast<std::size_t>(x), static_cast<std::size_t>(y))));
    }
    Moments* out = rows.data() + static_cast<std::size_t>(y - top) * reference.width;
    for (std::uint32_t x = box->x0; x < box->x1; ++x) {
      out[x] = blurred(line.data(), 1, static_cast<int>(x), width, kTaps);
    }
  }
  double sum = 0;
  std::size_t n = 0;
  for (std::uint32_t y = box->y0; y < box->y1; ++y) {
    for (std::uint32_t x = box->x0; x < box->x1; ++x) {
      if (!mask.at(x, y)) continue;
      // `rows` starts at `top`. It reaches kRadius beyond the box, so it is cut exactly where the
      // image is.
      sum += index_from(blurred(rows.data() + x, reference.width, static_cast<int>(y) - top,
                                bottom - top, kTaps));
      ++n;
    }
  }
  return sum / static_cast<double>(n);
}

std::optional<double> ssim_windows(const ImageView& reference, const ImageView& test,
                                   const PixelBox& box) {
  if (!comparable(reference, test)) return std::nullopt;
  const std::uint32_t x1 = std::min(box.x1, reference.width);
  const std::uint32_t y1 = std::min(box.y1, reference.height);
  if (box.x0 >= x1 || box.y0 >= y1) return std::nullopt;
  double sum = 0;
  std::size_t n = 0;
  for (std::uint32_t y = box.y0; y == box.y0 || y + kWindow <= y1; y += kStride) {
    for (std::uint32_t x = box.x0; x == box.x0 || x + kWindow <= x1; x += kStride) {
      sum += window_index(reference, test,
                          {x, y, std::min(x + kWindow, x1), std::min(y + kWindow, y1)});
      ++n;
    }
  }
  return sum / static_cast<double>(n);
}

}  // namespace mirage

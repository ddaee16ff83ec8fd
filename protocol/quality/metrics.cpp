#include "protocol/quality/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "protocol/quality/flip.h"

namespace mirage {
namespace {

constexpr int kCovered = 128;  // alpha of at least one half

bool measurable(const ImageView& reference, const ImageView& test, const Mask& mask) {
  return comparable(reference, test) && mask.fits(reference);
}

}  // namespace

std::optional<double> psnr_db(const ImageView& reference, const ImageView& test, const Mask& mask) {
  if (!measurable(reference, test, mask)) return std::nullopt;
  std::uint64_t squares = 0;  // 255^2 * 3 per pixel: exact for any image
  std::uint64_t values = 0;
  for (std::size_t i = 0; i < mask.inside.size(); ++i) {
    if (mask.inside[i] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const int d = reference.rgba[i * 4 + c] - test.rgba[i * 4 + c];
      squares += static_cast<std::uint64_t>(d * d);
    }
    values += 3;
  }
  if (values == 0) return std::nullopt;
  if (squares == 0) return std::numeric_limits<double>::infinity();
  const double mse = static_cast<double>(squares) / static_cast<double>(values);
  return 10.0 * std::log10(255.0 * 255.0 / mse);
}

std::optional<double> coverage_iou(const ImageView& reference, const ImageView& test) {
  if (!comparable(reference, test)) return std::nullopt;
  std::size_t both = 0, either = 0;
  for (std::size_t i = 0; i < reference.pixels(); ++i) {
    const bool a = reference.rgba[i * 4 + 3] >= kCovered;
    const bool b = test.rgba[i * 4 + 3] >= kCovered;
    both += a && b ? 1 : 0;
    either += a || b ? 1 : 0;
  }
  if (either == 0) return std::nullopt;
  return static_cast<double>(both) / static_cast<double>(either);
}

std::optional<double> mean_alpha_difference(const ImageView& reference, const ImageView& test,
                                            const Mask& mask) {
  if (!measurable(reference, test, mask)) return std::nullopt;
  std::uint64_t sum = 0, n = 0;
  for (std::size_t i = 0; i < mask.inside.size(); ++i) {
    if (mask.inside[i] == 0) continue;
    sum += static_cast<std::uint64_t>(std::abs(reference.rgba[i * 4 + 3] - test.rgba[i * 4 + 3]));
    ++n;
  }
  if (n == 0) return std::nullopt;
  return static_cast<double>(sum) / (255.0 * static_cast<double>(n));
}

ImageMeasures measure_images(const ImageView& reference, const ImageView& test) {
  const Mask mask = union_mask(reference, test);
  ImageMeasures out;
  out.mask_pixels = mask.count();
  if (const std::optional<FlipMap> map = flip_map(reference, test)) {
    out.flip_mean = flip_mean(*map, mask);
    out.flip_p99 = flip_quantile(*map, mask, 0.99);
  }
  out.psnr_db = psnr_db(reference, test, mask);
  out.ssim = ssim(reference, test, mask);
  out.coverage_iou = coverage_iou(reference, test);
  out.mean_alpha_difference = mean_alpha_difference(reference, test, mask);
  return out;
}

std::optional<double> flicker(const ImageView& reference_before, const ImageView& test_before,
                              const ImageView& reference, const ImageView& test) {
  const Mask mask = union_mask(reference, test);
  const bool fit = measurable(reference, test, mask) && measurable(reference, test_before, mask) &&
                   measurable(reference, reference_before, mask);
  if (!fit) return std::nullopt;
  std::uint64_t sum = 0, n = 0;
  for (std::size_t i = 0; i < mask.inside.size(); ++i) {
    if (mask.inside[i] == 0) continue;
    for (std::size_t c = i * 4; c < i * 4 + 3; ++c) {
      const int shown = test.rgba[c] - test_before.rgba[c];
      const int due = reference.rgba[c] - reference_before.rgba[c];
      sum += static_cast<std::uint64_t>(std::abs(shown - due));
    }
    n += 3;
  }
  if (n == 0) return std::nullopt;
  return static_cast<double>(sum) / (255.0 * static_cast<double>(n));
}

FieldFidelity field_fidelity(const ImageView& reference, const ImageView& test) {
  const std::optional<PixelBox> box = bounding_box(union_mask(reference, test, kCovered, 0));
  if (!box) return {};
  return {psnr_db(reference, test, box_mask(reference.width, reference.height, *box)),
          ssim_windows(reference, test, *box), coverage_iou(reference, test)};
}

void MeasureMean::add(const std::optional<double>& value) {
  if (!value || std::isnan(*value)) {
    ++not_available_;
  } else if (std::isinf(*value)) {
    ++identical_;
  } else {
    sum_ += *value;
    ++finite_;
  }
}

std::optional<double> MeasureMean::mean() const {
  if (finite_ == 0) return std::nullopt;
  return sum_ / static_cast<double>(finite_);
}

}  // namespace mirage

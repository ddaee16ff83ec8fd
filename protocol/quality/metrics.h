#pragma once
// Metrics: the measures of numerics.md section 1 on 8-bit images. nullopt means "n/a" everywhere:
// the images cannot be compared, or the mask is empty.

#include <cstddef>
#include <optional>

#include "protocol/quality/image_view.h"

namespace mirage {

/// Returns the PSNR in dB over the mask: 10 log10(255^2 / MSE). MSE is the mean of the squared
/// differences of the sRGB bytes of R, G and B. It is +infinity if they are equal on the mask:
/// print "inf", and average with MeasureMean, which leaves it out.
std::optional<double> psnr_db(const ImageView& reference, const ImageView& test, const Mask& mask);

/// Returns the SSIM (Wang, Bovik, Sheikh, Simoncelli 2004) of the luma 0.299 R + 0.587 G + 0.114 B
/// of the sRGB bytes: 11x11 Gaussian window of sigma 1.5, C1 = (0.01 255)^2, C2 = (0.03 255)^2. It
/// is the mean of the index at the pixels of the mask. Windows are cut at the image's border, and
/// their weights renormalised. Unit 1, at most 1.
std::optional<double> ssim(const ImageView& reference, const ImageView& test, const Mask& mask);

/// Returns the SSIM of the fidelity protocol: the same index over flat 8x8 windows every 4 px
/// inside `box`, averaged. A box under 8 px in one direction gives windows that are as small.
std::optional<double> ssim_windows(const ImageView& reference, const ImageView& test,
                                   const PixelBox& box);

/// Returns the intersection over union of the pixels with alpha >= 128, over the whole image;
/// nullopt if neither image covers a pixel.
std::optional<double> coverage_iou(const ImageView& reference, const ImageView& test);

/// Returns the mean |alpha - alpha'| / 255 over the mask: 0 to 1.
std::optional<double> mean_alpha_difference(const ImageView& reference, const ImageView& test,
                                            const Mask& mask);

/// The measures of one pair over the usual mask. Each of them may be n/a.
struct ImageMeasures {
  std::size_t mask_pixels = 0;
  std::optional<double> flip_mean;
  std::optional<double> flip_p99;  ///< 99 % of the pixels stay within it
  std::optional<double> psnr_db;
  std::optional<double> ssim;
  std::optional<double> coverage_iou;
  std::optional<double> mean_alpha_difference;
};
ImageMeasures measure_images(const ImageView& reference, const ImageView& test);

/// Returns the flicker of two successive frames (numerics.md section 1, E6), 0 to 2. It is the mean
/// over the mask of both references of
/// |(T - T_before) - (R - R_before)| / 255,
/// averaged over R, G and B.
std::optional<double> flicker(const ImageView& reference_before, const ImageView& test_before,
                              const ImageView& reference, const ImageView& test);

/// The fidelity protocol of the field: PSNR over the box of the union mask (alpha > 127, not
/// grown), SSIM in 8x8 windows over that box, IoU of the masks.
struct FieldFidelity {
  std::optional<double> psnr_db;
  std::optional<double> ssim;
  std::optional<double> iou;
};
FieldFidelity field_fidelity(const ImageView& reference, const ImageView& test);

/// Mean of a measure over many pairs. Infinite values (identical pairs) and n/a are counted, but
/// never averaged in.
class MeasureMean {
 public:
  void add(const std::optional<double>& value);
  /// Returns the mean; nullopt without any finite value.
  std::optional<double> mean() const;
  std::size_t finite() const { return finite_; }
  std::size_t identical() const { return identical_; }
  std::size_t not_available() const { return not_available_; }

 private:
  double sum_ = 0;
  std::size_t finite_ = 0;
  std::size_t identical_ = 0;
  std::size_t not_available_ = 0;
};

}  // namespace mirage

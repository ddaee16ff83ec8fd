// PSNR, SSIM, coverage and masks: closed forms, and the examples of numerics.md section 1.
#include "protocol/quality/metrics.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/quality_fixture.h"

namespace mirage::test {
namespace {

constexpr double kPi = 3.14159265358979;

TEST(QualityPsnr, ClosedForm) {
  TestImage a(10, 10, 100, 255), b(10, 10, 110, 255);
  const Mask all = full_mask(10, 10);
  EXPECT_NEAR(*psnr_db(a.view(), b.view(), all), 20 * std::log10(255.0 / 10.0), 1e-12);
  // Half of the values off by 10: half the squared error.
  TestImage half = a;
  for (std::size_t i = 0; i < 50; ++i) half.set(i % 10, i / 10, 110, 255);
  EXPECT_NEAR(*psnr_db(a.view(), half.view(), all),
              20 * std::log10(255.0 / 10.0) + 10 * std::log10(2.0), 1e-12);
}

TEST(QualityPsnr, IdenticalIsInfiniteAndNeverAveraged) {
  const TestImage a(6, 6, 50, 255);
  const auto same = psnr_db(a.view(), a.view(), full_mask(6, 6));
  ASSERT_TRUE(same);
  EXPECT_TRUE(std::isinf(*same) && *same > 0);
  MeasureMean mean;
  EXPECT_FALSE(mean.mean());
  mean.add(same);
  mean.add(std::nullopt);
  EXPECT_FALSE(mean.mean());
  mean.add(20.0);
  mean.add(30.0);
  EXPECT_DOUBLE_EQ(*mean.mean(), 25.0);
  EXPECT_EQ(mean.identical(), 1u);
  EXPECT_EQ(mean.not_available(), 1u);
  EXPECT_EQ(mean.finite(), 2u);
}

TEST(QualityPsnr, MaskedIsIndependentOfTheCanvas) {
  double first_masked = 0, last_whole = 0;
  for (const std::uint32_t size : {96u, 256u, 1024u}) {
    const TestImage a = disc_image(size, size * 0.5, size * 0.5, 40);
    const TestImage b = disc_image(size, size * 0.5 + 1, size * 0.5, 40);
    const double masked = *psnr_db(a.view(), b.view(), union_mask(a.view(), b.view()));
    const double whole = *psnr_db(a.view(), b.view(), full_mask(size, size));
    if (first_masked == 0) first_masked = masked;
    EXPECT_NEAR(masked, first_masked, 1e-9);
    EXPECT_GT(whole, last_whole + 2);  // the mask prevents this
    last_whole = whole;
  }
}

TEST(QualityCoverage, ShiftedDisc) {
  const double radius = 60;
  for (const double shift : {1.0, 2.0, 4.0}) {
    const TestImage a = disc_image(160, 80, 80, radius);
    const TestImage b = disc_image(160, 80 + shift, 80, radius);
    const double expected = 4 * shift / (kPi * radius);
    EXPECT_NEAR(1 - *coverage_iou(a.view(), b.view()), expected, 0.06 * expected) << shift;
  }
}

TEST(QualityCoverage, HalfIsCovered) {
  TestImage a(2, 1), b(2, 1);
  a.set(0, 0, 0, 128);
  b.set(0, 0, 0, 127);
  EXPECT_DOUBLE_EQ(*coverage_iou(a.view(), b.view()), 0.0);
  b.set(0, 0, 0, 128);
  EXPECT_DOUBLE_EQ(*coverage_iou(a.view(), b.view()), 1.0);
}

TEST(QualityCoverage, MeanAlphaDifference) {
  TestImage a(4, 1, 0, 0), b(4, 1, 0, 0);
  a.set(0, 0, 0, 255);
  b.set(1, 0, 0, 51);
  EXPECT_NEAR(*mean_alpha_difference(a.view(), b.view(), full_mask(4, 1)), 1.2 / 4, 1e-12);
  EXPECT_NEAR(*mean_alpha_difference(a.view(), b.view(), union_mask(a.view(), b.view(), 1, 0)), 0.6,
              1e-12);
}

TEST(QualitySsim, ConstantImages) {
  const TestImage a(32, 32, 100, 255), b(32, 32, 150, 255);
  const Mask all = full_mask(32, 32);
  const double c1 = 2.55 * 2.55;
  const double expected = (2 * 100.0 * 150 + c1) / (100.0 * 100 + 150.0 * 150 + c1);
  EXPECT_NEAR(*ssim(a.view(), b.view(), all), expected, 1e-9);
  EXPECT_NEAR(*ssim_windows(a.view(), b.view(), {0, 0, 32, 32}), expected, 1e-9);
  EXPECT_NEAR(*ssim(a.view(), a.view(), all), 1, 1e-12);
  EXPECT_NEAR(*ssim_windows(a.view(), a.view(), {3, 1, 20, 30}), 1, 1e-12);
}

/// Computes the index at one pixel straight from the definition: 121 weights, not separated.
double direct_ssim_at(const ImageView& a, const ImageView& b, int cx, int cy) {
  double w = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
  const auto luma = [](const std::uint8_t* p) {
    return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
  };
  for (int y = cy - 5; y <= cy + 5; ++y) {
    for (int x = cx - 5; x <= cx + 5; ++x) {
      if (x < 0 || y < 0 || x >= int(a.width) || y >= int(a.height)) continue;
      const double g = std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / 4.5);
      const double u = luma(a.pixel(std::size_t(x), std::size_t(y)));
      const double v = luma(b.pixel(std::size_t(x), std::size_t(y)));
      w += g, ma += g * u, mb += g * v, aa += g * u * u, bb += g * v * v, ab += g * u * v;
    }
  }
  ma /= w, mb /= w;
  const double va = aa / w - ma * ma, vb = bb / w - mb * mb, cov = ab / w - ma * mb;
  const double c1 = 6.5025, c2 = 58.5225;
  return (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

TEST(QualitySsim, AgreesWithTheDefinition) {
  std::mt19937 random(3);
  TestImage a(40, 30), b(40, 30);
  for (std::uint8_t& v : a.rgba) v = static_cast<std::uint8_t>(random());
  for (std::size_t i = 0; i < b.rgba.size(); ++i) {
    b.rgba[i] = static_cast<std::uint8_t>((a.rgba[i] * 3 + random() % 256) / 4);
  }
  for (const auto& [x, y] : {std::pair{0, 0}, {39, 29}, {20, 15}, {2, 27}, {5, 5}}) {
    Mask one{40, 30, std::vector<std::uint8_t>(1200, 0)};
    one.inside[std::size_t(y) * 40 + std::size_t(x)] = 1;
    EXPECT_NEAR(*ssim(a.view(), b.view(), one), direct_ssim_at(a.view(), b.view(), x, y), 1e-9);
  }
}

TEST(QualitySsim, WindowsStepByFour) {
  // A side of 16 px has windows at 0, 4 and 8. The pixel at (4, 4) lies in the windows that start
  // at 0 and at 4.
  TestImage a(16, 16, 128, 255), b = a;
  b.set(4, 4, 255, 255);
  const double mean = *ssim_windows(a.view(), b.view(), {0, 0, 16, 16});
  const double hit = *ssim_windows(a.view(), b.view(), {0, 0, 8, 8});
  EXPECT_LT(hit, 0.9);
  EXPECT_NEAR(mean, (4 * hit + 5) / 9, 1e-9);
  EXPECT_TRUE(ssim_windows(a.view(), b.view(), {3, 3, 6, 5}));  // smaller than a window
  EXPECT_FALSE(ssim_windows(a.view(), b.view(), {5, 5, 5, 9}));
}

TEST(QualityMask, GrowsByTwo) {
  TestImage a(9, 9), b(9, 9);
  a.set(4, 4, 0, 1);
  EXPECT_EQ(union_mask(a.view(), b.view()).count(), 25u);
  EXPECT_EQ(union_mask(b.view(), a.view()).count(), 25u);
  a.set(0, 8, 0, 1);  // the window is cut at the corner; 3x3 there
  EXPECT_EQ(union_mask(a.view(), b.view()).count(), 25u + 9u - 1u);
  const auto box = bounding_box(union_mask(a.view(), b.view(), 1, 0));
  ASSERT_TRUE(box);
  EXPECT_EQ(box->x0, 0u);
  EXPECT_EQ(box->x1, 5u);
  EXPECT_EQ(box->y0, 4u);
  EXPECT_EQ(box->y1, 9u);
}

TEST(QualityMask, EmptyMeansNotAvailable) {
  const TestImage a(16, 16), other(16, 17);
  const Mask none = union_mask(a.view(), a.view());
  EXPECT_EQ(none.count(), 0u);
  EXPECT_FALSE(psnr_db(a.view(), a.view(), none));
  EXPECT_FALSE(ssim(a.view(), a.view(), none));
  EXPECT_FALSE(mean_alpha_difference(a.view(), a.view(), none));
  EXPECT_FALSE(coverage_iou(a.view(), a.view()));
  EXPECT_FALSE(psnr_db(a.view(), other.view(), full_mask(16, 16)));
  const ImageMeasures m = measure_images(a.view(), a.view());
  EXPECT_FALSE(m.flip_mean || m.psnr_db || m.ssim || m.coverage_iou || m.mean_alpha_difference);
  EXPECT_FALSE(field_fidelity(a.view(), a.view()).psnr_db);
}

TEST(QualityMeasures, DiscPair) {
  const TestImage a = disc_image(96, 48, 48, 30), b = disc_image(96, 49, 48, 30);
  const ImageMeasures m = measure_images(a.view(), b.view());
  EXPECT_GT(m.mask_pixels, 2800u);
  EXPECT_GT(*m.flip_mean, 0.02);
  EXPECT_GT(*m.ssim, 0.3);
  EXPECT_LT(*m.ssim, 0.99);
  const FieldFidelity field = field_fidelity(a.view(), b.view());
  EXPECT_DOUBLE_EQ(*field.iou, *m.coverage_iou);
  // The box of the disc at alpha > 127 holds less background than the grown mask, which has none
  // outside.
  EXPECT_NEAR(*field.psnr_db, *m.psnr_db, 2.0);
}

// E6: a change that should happen is no flicker; a pop counts by its size and area.
TEST(QualityFlicker, OnlyChangesThatWereNotDueCount) {
  TestImage truth(8, 8, 100, 255), shown(8, 8, 90, 255);
  TestImage truth_next(8, 8, 120, 255), shown_next(8, 8, 110, 255);
  const auto measure = [&] {
    return flicker(truth.view(), shown.view(), truth_next.view(), shown_next.view());
  };
  EXPECT_DOUBLE_EQ(*measure(), 0.0) << "a constant error does not flicker";
  for (std::size_t x = 0; x < 8; ++x) shown_next.set(x, 3, 110 + 51, 255);
  EXPECT_DOUBLE_EQ(*measure(), 0.2 / 8) << "one row of eight, 51 of 255 off";
  const TestImage nothing(8, 8), other(8, 9);
  EXPECT_FALSE(flicker(nothing.view(), nothing.view(), nothing.view(), nothing.view()));
  EXPECT_FALSE(flicker(other.view(), shown.view(), truth_next.view(), shown_next.view()));
}

}  // namespace
}  // namespace mirage::test

// FLIP compared with reference values, and properties that must hold without any.
#include "protocol/quality/flip.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/support/data_folder.h"
#include "tests/support/quality_fixture.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

TestImage read_png(const fs::path& path) {
  const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path.string());
  if (!in) {
    ADD_FAILURE() << "cannot read " << path;
    return {0, 0};
  }
  const OIIO::ImageSpec& spec = in->spec();
  TestImage image(static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height),
                  0, 255);
  const int channels = std::min(spec.nchannels, 4);
  EXPECT_GE(channels, 3);
  EXPECT_TRUE(in->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, image.rgba.data(), 4));
  return image;
}

TEST(QualityFlip, TheWorstPlaceIsTheSquareThatDiffersMost) {
  FlipMap map{40, 20, std::vector<float>(800, 0.01f)};
  map.error[3 * 40 + 5] = 1;  // one pixel
  for (std::uint32_t y = 8; y < 12; ++y) {
    for (std::uint32_t x = 30; x < 34; ++x) map.error[y * 40 + x] = 0.5f;
  }
  const auto worst = flip_worst_place(map, 4);
  ASSERT_TRUE(worst);
  EXPECT_DOUBLE_EQ(worst->x, 32.0 / 40);
  EXPECT_DOUBLE_EQ(worst->y, 10.0 / 20);
  EXPECT_NEAR(worst->flip, 0.5, 1e-6);
  const auto small = flip_worst_place(map, 1);
  ASSERT_TRUE(small);
  EXPECT_NEAR(small->x, 5.5 / 40, 1e-9) << "a pixel is the smallest square";
  const auto whole = flip_worst_place(map, 1000);
  ASSERT_TRUE(whole);
  EXPECT_DOUBLE_EQ(whole->x, 0.5);
  EXPECT_DOUBLE_EQ(whole->y, 0.5);
  EXPECT_FALSE(flip_worst_place({}, 4));
  EXPECT_FALSE(flip_worst_place(map, 0));
}

// Soft limit 1e-4 on the mean: independent implementations agree to that. 1e-3 on the maximum: one
// pixel, float against float.
TEST(QualityFlip, AgreesWithTheReferenceImplementation) {
  const fs::path folder = data_folder() / "flip_reference";
  std::ifstream table(folder / "values.tsv");
  ASSERT_TRUE(table) << "no FLIP reference values at " << folder;
  std::string line;
  std::getline(table, line);
  int pairs = 0;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::string name;
    double mean = -1, largest = -1;
    ASSERT_TRUE(row >> name >> mean >> largest) << line;
    const TestImage reference = read_png(folder / (name + "_reference.png"));
    const TestImage test = read_png(folder / (name + "_test.png"));
    const auto map = flip_map(reference.view(), test.view());
    ASSERT_TRUE(map) << name;
    EXPECT_NEAR(*flip_mean(*map), mean, 1e-4) << name;
    EXPECT_NEAR(*flip_max(*map, full_mask(map->width, map->height)), largest, 1e-3) << name;
    RecordProperty(name, std::to_string(*flip_mean(*map)));
    ++pairs;
  }
  EXPECT_GE(pairs, 8);
}

TEST(QualityFlip, EqualImagesGiveExactlyZero) {
  const TestImage image = disc_image(64, 32, 32, 20);
  const auto map = flip_map(image.view(), image.view());
  ASSERT_TRUE(map);
  for (const float e : map->error) ASSERT_EQ(e, 0.0f);
}

TEST(QualityFlip, StaysWithinZeroAndOneAndIsSymmetric) {
  std::mt19937 random(7);
  TestImage a(48, 40), b(48, 40);
  for (std::uint8_t& v : a.rgba) v = random() & 1 ? 255 : 0;
  for (std::uint8_t& v : b.rgba) v = random() & 1 ? 255 : 0;
  const auto ab = flip_map(a.view(), b.view());
  const auto ba = flip_map(b.view(), a.view());
  ASSERT_TRUE(ab && ba);
  for (std::size_t i = 0; i < ab->error.size(); ++i) {
    ASSERT_GE(ab->error[i], 0.0f);
    ASSERT_LE(ab->error[i], 1.0f);
    ASSERT_FLOAT_EQ(ab->error[i], ba->error[i]);
  }
}

TEST(QualityFlip, LargerDensityForgivesMore) {
  const TestImage a = disc_image(96, 48, 48, 30);
  TestImage b = a;
  for (std::size_t i = 0; i < b.rgba.size(); ++i) {  // a checkerboard of mean zero
    if (i % 4 == 3) continue;
    b.rgba[i] = static_cast<std::uint8_t>(b.rgba[i] + ((i / 4 + i / 4 / 96) % 2 == 0 ? 8 : -8));
  }
  const auto near = flip_map(a.view(), b.view(), 20);
  const auto far = flip_map(a.view(), b.view(), 120);
  ASSERT_TRUE(near && far);
  EXPECT_GT(*flip_mean(*near), 1.5 * *flip_mean(*far));
}

// A plate of 1 % of the object that is striped: the mean hardly tells, the 99th percentile does.
TEST(QualityFlip, ThePercentileShowsWhatTheMeanHides) {
  FlipMap map{100, 10, std::vector<float>(1000, 0.001f)};
  std::fill_n(map.error.begin(), 15, 0.8f);
  EXPECT_LT(*flip_mean(map), 0.015);
  EXPECT_NEAR(*flip_quantile(map, full_mask(100, 10), 0.99), 0.8, 1e-6);
  const std::vector<std::uint8_t> heat = heat_map(map);
  ASSERT_EQ(heat.size(), 4000u);
  EXPECT_GT(heat[0] + heat[1] + heat[2], 600) << "bright where it is wrong";
  EXPECT_LT(heat[4 * 500] + heat[4 * 500 + 1] + heat[4 * 500 + 2], 20);
}

TEST(QualityFlip, MaskAndQuartiles) {
  FlipMap map{4, 1, {0.1f, 0.2f, 0.3f, 0.4f}};
  Mask mask{4, 1, {0, 1, 1, 0}};
  EXPECT_NEAR(*flip_mean(map), 0.25, 1e-7);
  EXPECT_NEAR(*flip_mean(map, mask), 0.25, 1e-7);
  EXPECT_NEAR(*flip_max(map, mask), 0.3, 1e-7);
  EXPECT_NEAR(*flip_quantile(map, mask, 0), 0.2, 1e-7);
  EXPECT_NEAR(*flip_quantile(map, mask, 0.99), 0.3, 1e-7);
  EXPECT_FALSE(flip_quantile(map, Mask{4, 1, {0, 0, 0, 0}}, 0.99)) << "nothing inside";
  mask.inside = {1, 0, 0, 1};
  EXPECT_NEAR(*flip_max(map, mask), 0.4, 1e-7);
  // Cumulative error .1 .3 .6 1: a quarter is reached at .2, a half at .3, three quarters at .4.
  const auto q = flip_quartiles(map, full_mask(4, 1));
  ASSERT_TRUE(q);
  EXPECT_NEAR(q->first, 0.2, 1e-7);
  EXPECT_NEAR(q->median, 0.3, 1e-7);
  EXPECT_NEAR(q->third, 0.4, 1e-7);
}

TEST(QualityFlip, RefusesWhatCannotBeCompared) {
  const TestImage a(8, 8), b(8, 9), none(0, 0);
  EXPECT_FALSE(flip_map(a.view(), b.view()));
  EXPECT_FALSE(flip_map(none.view(), none.view()));
  EXPECT_FALSE(flip_map(a.view(), a.view(), 0));
  EXPECT_FALSE(flip_map(a.view(), a.view(), std::nan("")));
  const auto map = flip_map(a.view(), a.view());
  ASSERT_TRUE(map);
  EXPECT_FALSE(flip_mean(*map, full_mask(8, 9)));
  EXPECT_FALSE(flip_mean(*map, Mask{8, 8, std::vector<std::uint8_t>(64, 0)}));
  EXPECT_FALSE(flip_quartiles(*map, Mask{8, 8, std::vector<std::uint8_t>(64, 0)}));
}

TEST(QualityFlip, OnePixelAndOneRow) {
  for (const auto& [w, h] : {std::pair{1u, 1u}, {5u, 1u}, {1u, 70u}}) {
    const TestImage a(w, h, 0, 255), b(w, h, 255, 255);
    const auto map = flip_map(a.view(), b.view());
    ASSERT_TRUE(map);
    for (const float e : map->error) EXPECT_NEAR(e, 0.967388f, 1e-4f);
  }
}

}  // namespace
}  // namespace mirage::test

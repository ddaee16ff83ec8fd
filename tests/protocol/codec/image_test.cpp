// Images on the wire: exact where they must be, lossy only where the hue stays.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/codec/image_codec.h"

namespace mirage::test {
namespace {

Image painted(std::uint32_t w, std::uint32_t h, bool srgb) {
  Image image{w, h, srgb, {}};
  for (std::uint32_t y = 0; y < h; ++y) {
    for (std::uint32_t x = 0; x < w; ++x) {
      for (const std::uint32_t v :
           {x * 255 / w, y * 255 / h, (x + y) % 32 * 4 + 60, (x / 8 + y / 8) % 2 * 255}) {
        image.rgba.push_back(static_cast<std::uint8_t>(v));
      }
    }
  }
  return image;
}

TEST(ProtocolImage, ColourCloseAlphaExact) {
  const Image image = painted(96, 64, true);
  const Result<Bytes> bytes = encode_image(image);
  ASSERT_TRUE(bytes);
  EXPECT_LT(bytes->size(), image.rgba.size() / 4);
  const Result<Image> back = decode_image(bytes->data(), bytes->size(), {96, 64}, true);
  ASSERT_TRUE(back);
  double sum = 0;
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    const double d = double(image.rgba[i]) - double(back->rgba[i]);
    if (i % 4 == 3) {
      ASSERT_EQ(d, 0);
    }
    sum += d * d;
  }
  EXPECT_LT(std::sqrt(sum / static_cast<double>(image.rgba.size())),
            7);  // of 255; stripes four texels wide
}

TEST(ProtocolImage, DataIsExact) {
  Image image = painted(33, 17, false);
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  const Result<Bytes> bytes = encode_image(image);
  const Result<Image> back = decode_image(bytes->data(), bytes->size(), {33, 17}, false);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->rgba, image.rgba);
}

// Returns noise of the given strength around a gradient, in brightness alone or in each channel.
Image photographed(std::uint32_t edge, int noise, bool gray_noise) {
  Image image{edge, edge, true, {}};
  std::mt19937 random(7);
  std::uniform_int_distribution<int> grain(-noise, noise);
  for (std::uint32_t i = 0; i < edge * edge; ++i) {
    const int all = grain(random);
    for (const int base : {int(i % edge * 90 / edge) + 80, int(i / edge * 90 / edge) + 60, 110}) {
      image.rgba.push_back(static_cast<std::uint8_t>(base + (gray_noise ? all : grain(random))));
    }
    image.rgba.push_back(255);
  }
  return image;
}

Image sent(const Image& image, std::size_t* bytes = nullptr) {
  const Result<Bytes> encoded = encode_image(image);
  if (bytes) *bytes = encoded->size();
  return decode_image(encoded->data(), encoded->size(), {image.width, image.height}, true).take();
}

TEST(ProtocolImage, HueErrorIsOfWhatAFilterShows) {
  Image image = photographed(64, 0, true);
  Image shown = image;
  EXPECT_EQ(hue_error(image, shown).p95, 0);
  for (std::size_t i = 0; i < shown.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) shown.rgba[i + c] += 9;  // brighter: the hue is the same
  }
  EXPECT_EQ(hue_error(image, shown).p95, 0);
  for (std::size_t i = 0; i < shown.rgba.size(); i += 8) {
    shown.rgba[i] += 8;
    shown.rgba[i + 4] -= 8;
  }
  EXPECT_EQ(hue_error(image, shown).p95, 0) << "neighbours that cancel out";
  for (std::size_t i = 0; i < shown.rgba.size(); i += 4) shown.rgba[i] += 6;
  EXPECT_EQ(hue_error(image, shown).median, 6);
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 0;
  EXPECT_EQ(hue_error(image, shown).median, 0) << "nothing of it is seen";
}

TEST(ProtocolImage, FewColoursAndSmallImagesAreExact) {
  Image palette{256, 1, true, {}};
  for (std::uint32_t i = 0; i < 256; ++i) {
    for (const std::uint32_t v : {i * 37 % 256, i * 91 % 256, i * 53 % 256, 255u}) {
      palette.rgba.push_back(static_cast<std::uint8_t>(v));
    }
  }
  EXPECT_EQ(sent(palette).rgba, palette.rgba);
  Image poster{320, 200, true, {}};
  for (std::uint32_t i = 0; i < 320 * 200; ++i) {
    // Greys have no hue to lose, but they are sent as they are.
    const auto grey = static_cast<std::uint8_t>((i / 16 % 20 + i / 320 / 16) * 37 % 256);
    poster.rgba.insert(poster.rgba.end(), {grey, grey, grey, 255});
  }
  EXPECT_EQ(sent(poster).rgba, poster.rgba);
  const Image small = photographed(64, 40, false);
  EXPECT_EQ(sent(small).rgba, small.rgba);
}

TEST(ProtocolImage, LossOnlyWhereTheHueStays) {
  std::size_t bytes = 0;
  const Image photo = photographed(256, 12, true);
  const Image shown = sent(photo, &bytes);
  EXPECT_NE(shown.rgba, photo.rgba) << "loss is allowed here";
  EXPECT_LT(bytes, photo.rgba.size() / 3 / 2);
  EXPECT_LE(hue_error(photo, shown).median, kHueLimit.median);
  EXPECT_LE(hue_error(photo, shown).p95, kHueLimit.p95);
  const Image confetti = photographed(128, 60, false);  // each texel its own hue
  EXPECT_EQ(sent(confetti).rgba, confetti.rgba);
}

TEST(ProtocolImage, AnotherSizeOrDamageIsRefused) {
  const Bytes bytes = encode_image(painted(16, 16, true)).take();
  EXPECT_EQ(decode_image(bytes.data(), bytes.size(), {16, 17}, true).error().id, ErrorId::kCodec);
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_FALSE(decode_image(bytes.data(), n, {16, 16}, true)) << n;
  }
}

TEST(ProtocolImage, Levels) {
  EXPECT_EQ(image_levels({1, 1, true, {}, 0}), 1);
  EXPECT_EQ(image_levels({64, 64, true, {}, 0}), 1);
  EXPECT_EQ(image_levels({65, 3, true, {}, 0}), 2);
  EXPECT_EQ(image_levels({300, 2048, true, {}, 0}), 4);
  EXPECT_EQ(image_levels({16384, 16384, true, {}, 0}), 4);
  const ImageDescription large{16384, 1000, true, {}, 0};
  EXPECT_EQ(image_level_size(large, 3), glm::uvec2(4096, 250));
  EXPECT_EQ(image_level_size(large, 0), glm::uvec2(64, 3));
  EXPECT_EQ(image_level_size({100, 50, true, {}, 0}, 1), glm::uvec2(100, 50));
}

}  // namespace
}  // namespace mirage::test

#include "protocol/codec/image_codec.h"

#include <webp/decode.h>
#include <webp/encode.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <unordered_set>

namespace mirage {
namespace {

constexpr std::array<float, 2> kColorQualities = {90, 97};
constexpr float kLosslessEffort = 70;  // 0..100
// Images with at most this many colours are usually drawn, not photographed. Lossless coding then
// takes 0.2 to 1.4 times the bytes of lossy coding.
constexpr std::size_t kFewColors = 4096;
constexpr std::size_t kSmallTexels = 64 * 64;  // 16 KB at most without loss
constexpr int kMethod = 4;  // 0 fast .. 6 small; 6 takes three times as long for 3 %

}  // namespace

std::uint8_t image_levels(const ImageDescription& image) {
  const std::uint32_t edge = std::max(image.width, image.height);
  std::uint8_t levels = 1;
  while (levels < kImageLevelEdges.size() && edge > kImageLevelEdges[levels - 1u]) ++levels;
  return levels;
}

glm::uvec2 image_level_size(const ImageDescription& image, std::uint8_t level) {
  const std::uint32_t most =
      kImageLevelEdges[std::min<std::size_t>(level, kImageLevelEdges.size() - 1)];
  glm::uvec2 size(image.width, image.height);
  while (std::max(size.x, size.y) > most) size = glm::max(size / 2u, glm::uvec2(1));
  return size;
}

namespace {

// `quality`: 0..100; nullopt: lossless.
Result<Bytes> encode_webp(const Image& image, std::optional<float> quality) {
  WebPConfig config;
  WebPPicture picture;
  if (!WebPConfigPreset(&config, WEBP_PRESET_DEFAULT, quality.value_or(kLosslessEffort)) ||
      !WebPPictureInit(&picture)) {
    return make_error(ErrorId::kCodec, "libwebp is not the version this was built with");
  }
  config.method = kMethod;
  config.exact = 1;  // keeps colours under alpha 0, which filtering mixes into neighbours
  config.use_sharp_yuv = 1;
  config.lossless = quality ? 0 : 1;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  picture.use_argb = 1;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const bool encoded = WebPPictureImportRGBA(&picture, image.rgba.data(), picture.width * 4) &&
                       WebPEncode(&config, &picture);
  WebPPictureFree(&picture);
  Bytes out;
  if (encoded) out.assign(writer.mem, writer.mem + writer.size);
  WebPMemoryWriterClear(&writer);
  if (!encoded) return make_error(ErrorId::kCodec, "an image cannot be encoded");
  return out;
}

bool has_few_colors(const Image& image) {
  std::unordered_set<std::uint32_t> colors;
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
    std::uint32_t color = 0;
    std::memcpy(&color, &image.rgba[i], sizeof(color));
    colors.insert(color);
    if (colors.size() > kFewColors) return false;
  }
  return true;
}

float at_share(std::vector<float>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

HueError hue_error(const Image& image, const Image& shown) {
  std::vector<float> errors;
  for (std::uint32_t y = 0; y < image.height; y += 2) {
    for (std::uint32_t x = 0; x < image.width; x += 2) {
      glm::vec3 change(0);
      float weight = 0;
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t sx = std::min(x + k % 2, image.width - 1);
        const std::uint32_t sy = std::min(y + k / 2, image.height - 1);
        const std::size_t i = (std::size_t{sy} * image.width + sx) * 4;
        const auto at = [i](const Image& of) {
          return glm::vec3(of.rgba[i], of.rgba[i + 1], of.rgba[i + 2]);
        };
        const float alpha = image.rgba[i + 3];
        change += alpha * (at(shown) - at(image));
        weight += alpha;
      }
      if (weight == 0) continue;
      change /= weight;
      errors.push_back(std::max(std::abs(change.r - change.g), std::abs(change.b - change.g)));
    }
  }
  if (errors.empty()) return {};
  const float median = at_share(errors, 0.5);
  return {median, at_share(errors, 0.95)};
}

Result<Bytes> encode_image(const Image& image) {
  const bool exact = !image.srgb || std::size_t{image.width} * image.height <= kSmallTexels ||
                     has_few_colors(image);
  if (exact) return encode_webp(image, std::nullopt);
  for (const float quality : kColorQualities) {
    Result<Bytes> bytes = encode_webp(image, quality);
    if (!bytes) return bytes;
    const Result<Image> back =
        decode_image(bytes->data(), bytes->size(), {image.width, image.height}, true);
    if (!back) return back.error();
    const HueError error = hue_error(image, *back);
    if (error.median <= kHueLimit.median && error.p95 <= kHueLimit.p95) return bytes;
  }
  return encode_webp(image, std::nullopt);
}

std::optional<glm::uvec2> encoded_image_size(const std::uint8_t* bytes, std::size_t size) {
  int width = 0, height = 0;
  if (!WebPGetInfo(bytes, size, &width, &height)) return std::nullopt;
  const int most = static_cast<int>(kImageLevelEdges.back());
  if (width < 1 || height < 1 || width > most || height > most) return std::nullopt;
  return glm::uvec2(width, height);
}

Result<Image> decode_image(const std::uint8_t* bytes, std::size_t size, const glm::uvec2& expected,
                           bool srgb) {
  int width = 0, height = 0;
  if (!WebPGetInfo(bytes, size, &width, &height) || width != static_cast<int>(expected.x) ||
      height != static_cast<int>(expected.y)) {
    return make_error(ErrorId::kCodec, "an image is not of the size it was asked for");
  }
  Image image;
  image.width = expected.x;
  image.height = expected.y;
  image.srgb = srgb;
  image.rgba.resize(std::size_t{image.width} * image.height * 4);
  if (!WebPDecodeRGBAInto(bytes, size, image.rgba.data(), image.rgba.size(), width * 4)) {
    return make_error(ErrorId::kCodec, "an image is damaged");
  }
  return image;
}

}  // namespace mirage

#include "protocol/image_codec.h"

#include <webp/decode.h>
#include <webp/encode.h>

#include <algorithm>

namespace mirage {
namespace {

constexpr float kColorQuality = 90;
constexpr float kLosslessEffort = 70;  // 0..100
constexpr int kMethod = 4;             // 0 fast .. 6 small; 6 takes three times as long for 3 %

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

Result<Bytes> encode_image(const Image& image) {
  WebPConfig config;
  WebPPicture picture;
  if (!WebPConfigPreset(&config, WEBP_PRESET_DEFAULT, kColorQuality) ||
      !WebPPictureInit(&picture)) {
    return make_error(ErrorId::kCodec, "libwebp is not the version this was built with");
  }
  config.method = kMethod;
  config.exact = 1;  // what is transparent still bleeds into its neighbours when filtered
  config.use_sharp_yuv = 1;
  if (!image.srgb) {
    config.lossless = 1;
    config.quality = kLosslessEffort;
  }
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

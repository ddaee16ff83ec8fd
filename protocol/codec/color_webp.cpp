#include <webp/decode.h>
#include <webp/encode.h>

#include "protocol/codec/color_codec.h"

namespace mirage {
namespace {

constexpr int kColorMethod = 2;  // 0 fast .. 6 small

}  // namespace

ColorBytes encode_webp_colors(const ColorBytes& colors, std::uint32_t w, std::uint32_t h,
                              float quality) {
  WebPConfig config;
  WebPPicture picture;
  if (!WebPConfigPreset(&config, WEBP_PRESET_DEFAULT, quality) || !WebPPictureInit(&picture)) {
    return {};
  }
  config.method = kColorMethod;
  picture.width = static_cast<int>(w);
  picture.height = static_cast<int>(h);
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const bool encoded = WebPPictureImportRGBX(&picture, colors.data(), picture.width * 4) &&
                       WebPEncode(&config, &picture);
  WebPPictureFree(&picture);
  ColorBytes out;
  if (encoded) out.assign(writer.mem, writer.mem + writer.size);
  WebPMemoryWriterClear(&writer);
  return out;
}

Result<ColorBytes> decode_webp_colors(const std::uint8_t* bytes, std::size_t size, std::uint32_t w,
                                      std::uint32_t h) {
  int width = 0, height = 0;
  if (!WebPGetInfo(bytes, size, &width, &height) || width != static_cast<int>(w) ||
      height != static_cast<int>(h)) {
    return make_error(ErrorId::kCodec, "WebP colours are not of the size of their tile");
  }
  ColorBytes out(std::size_t{w} * h * 4);
  if (!WebPDecodeRGBAInto(bytes, size, out.data(), out.size(), width * 4)) {
    return make_error(ErrorId::kCodec, "WebP colours are damaged");
  }
  return out;
}

}  // namespace mirage

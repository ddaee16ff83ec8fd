#include "client/view/animation.h"

#include <webp/encode.h>
#include <webp/mux.h>

#include <cmath>
#include <fstream>
#include <memory>

#include "client/view/sheet_image.h"

namespace mirage {
namespace {

constexpr float kQuality = 75;  // 640 x 360 on a walk through a wood: 18 KB a frame
constexpr int kKeyEvery = 24;   // frames; those between are coded as differences

using Encoder = std::unique_ptr<WebPAnimEncoder, decltype(&WebPAnimEncoderDelete)>;

Error cannot(const std::string& what) { return make_error(ErrorId::kIo, "cannot " + what); }

Result<Encoder> make_encoder(int width, int height) {
  WebPAnimEncoderOptions options;
  if (!WebPAnimEncoderOptionsInit(&options)) return cannot("use this libwebpmux");
  options.kmin = kKeyEvery - 1;
  options.kmax = kKeyEvery;
  Encoder encoder(WebPAnimEncoderNew(width, height, &options), &WebPAnimEncoderDelete);
  if (!encoder) return cannot("animate images of this size");
  return encoder;
}

Result<void> add_frame(WebPAnimEncoder& encoder, const SheetImage& image, int at_ms) {
  WebPConfig config;
  WebPPicture picture;
  if (!WebPConfigPreset(&config, WEBP_PRESET_PHOTO, kQuality) || !WebPPictureInit(&picture)) {
    return cannot("use this libwebp");
  }
  picture.use_argb = 1;
  picture.width = image.width;
  picture.height = image.height;
  const bool added = WebPPictureImportRGBX(&picture, image.rgba.data(), 4 * image.width) &&
                     WebPAnimEncoderAdd(&encoder, &picture, at_ms, &config);
  WebPPictureFree(&picture);
  if (!added) return cannot(std::string("animate: ") + WebPAnimEncoderGetError(&encoder));
  return {};
}

}  // namespace

Result<void> write_animation(const std::vector<std::string>& images, double frames_per_second,
                             const std::string& target) {
  if (images.empty()) return make_error(ErrorId::kUsage, "no images to animate");
  Encoder encoder(nullptr, &WebPAnimEncoderDelete);
  int w = 0, h = 0;
  const auto at_ms = [&](std::size_t frame) {
    return static_cast<int>(std::lround(1000.0 * static_cast<double>(frame) / frames_per_second));
  };
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Result<SheetImage> image = read_sheet_image(images[i]);
    if (!image) return image.error();
    if (i == 0) {
      w = image->width;
      h = image->height;
      Result<Encoder> made = make_encoder(w, h);
      if (!made) return made.error();
      encoder = made.take();
    } else if (image->width != w || image->height != h) {
      return make_error(ErrorId::kUsage, "'" + images[i] + "' has another size than the first");
    }
    if (Result<void> added = add_frame(*encoder, *image, at_ms(i)); !added) return added;
  }
  WebPAnimEncoderAdd(encoder.get(), nullptr, at_ms(images.size()),
                     nullptr);  // sets the duration of the last frame
  WebPData data;
  WebPDataInit(&data);
  const bool assembled = WebPAnimEncoderAssemble(encoder.get(), &data) != 0;
  std::ofstream file(target, std::ios::binary);
  if (assembled) {
    file.write(reinterpret_cast<const char*>(data.bytes), static_cast<std::streamsize>(data.size));
  }
  WebPDataClear(&data);
  file.close();
  if (!assembled || !file) return cannot("write '" + target + "'");
  return {};
}

}  // namespace mirage

#include "server/tile/picture_encode.h"

#include "modules/image_library.h"

namespace mirage {
namespace {

struct Kind {
  PictureFormat format;
  const char* name;
  const char* media_type;
  const char* file;         ///< whose ending tells OpenImageIO the format
  const char* compression;  ///< with a quality at which errors hardly show
};
constexpr Kind kKinds[] = {
    {PictureFormat::kWebp, "webp", "image/webp", "a.webp", "webp:85"},
    {PictureFormat::kPng, "png", "image/png", "a.png", "none:6"},
    {PictureFormat::kJpeg, "jpeg", "image/jpeg", "a.jpg", "jpeg:88"},
};

const Kind& kind_of(PictureFormat format) { return kKinds[static_cast<std::size_t>(format)]; }

}  // namespace

std::optional<PictureFormat> picture_format(const std::string& name) {
  for (const Kind& kind : kKinds) {
    if (name == kind.name) return kind.format;
  }
  return std::nullopt;
}

const char* media_type(PictureFormat format) { return kind_of(format).media_type; }

Result<Bytes> encode_picture(const RenderedReference& drawn, PictureFormat format) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  const std::vector<std::uint8_t>& rgba = drawn.frame.rgba;
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    rgb.insert(rgb.end(), {rgba[i], rgba[i + 1], rgba[i + 2]});
  }
  const Kind& kind = kind_of(format);
  return (*library)->encode(
      kind.file, {static_cast<int>(drawn.width), static_cast<int>(drawn.height), 3, rgb.data()},
      kind.compression);
}

}  // namespace mirage

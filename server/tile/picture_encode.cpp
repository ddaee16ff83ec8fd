#include "server/tile/picture_encode.h"

#include "modules/image_library.h"
#include "server/tile/impostor_file.h"

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
    {PictureFormat::kImpostor, "impostor", "image/webp", "a.webp", "webp:85"},
};
// Coarser forms of an impostor, until it is small enough.
constexpr const char* kCoarser[] = {"webp:75", "webp:65", "webp:55", "webp:45",
                                    "webp:35", "webp:25", "webp:15", "webp:5"};

const Kind& kind_of(PictureFormat format) { return kKinds[static_cast<std::size_t>(format)]; }

}  // namespace

std::optional<PictureFormat> picture_format(const std::string& name) {
  for (const Kind& kind : kKinds) {
    if (name == kind.name) return kind.format;
  }
  return std::nullopt;
}

const char* media_type(PictureFormat format) { return kind_of(format).media_type; }

namespace {

Result<Bytes> encode_impostor(const PictureName& name, const SceneFrame& frame,
                              const ImageLibrary& library, const ImagePixels<std::uint8_t>& rgb) {
  const Result<Bytes> chunk = impostor_chunk(name.camera, frame);
  if (!chunk) return chunk.error();
  const auto encode = [&](const char* compression) -> Result<Bytes> {
    Result<Bytes> colors = library.encode("a.webp", rgb, compression);
    return colors ? with_chunk(*colors, name.camera, *chunk) : colors;
  };
  Result<Bytes> out = encode(kind_of(PictureFormat::kImpostor).compression);
  for (const char* const coarser : kCoarser) {
    if (!out || name.most_bytes == 0 || out->size() <= name.most_bytes) return out;
    out = encode(coarser);
  }
  return out;
}

}  // namespace

Result<Bytes> encode_picture(const RenderedReference& drawn, const PictureName& name) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  const std::vector<std::uint8_t>& rgba = drawn.frame.rgba;
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    rgb.insert(rgb.end(), {rgba[i], rgba[i + 1], rgba[i + 2]});
  }
  const ImagePixels<std::uint8_t> pixels{static_cast<int>(drawn.width),
                                         static_cast<int>(drawn.height), 3, rgb.data()};
  if (name.format == PictureFormat::kImpostor) {
    return encode_impostor(name, drawn.frame, **library, pixels);
  }
  const Kind& kind = kind_of(name.format);
  return (*library)->encode(kind.file, pixels, kind.compression);
}

}  // namespace mirage

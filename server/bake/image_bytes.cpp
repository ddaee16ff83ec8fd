#include "server/bake/image_bytes.h"

#include <algorithm>
#include <cmath>

#include "modules/image_library.h"

namespace mirage {
namespace {

// Levels go from 1 to 9. Colour and normal of the knot at 2048 x 2048: 3 takes .35 s and 2.9 MB, 6
// takes .8 s and 2.7 MB.
constexpr const char* kPngLevel = "png:3";

template <typename T>
std::vector<T> rounded(const std::vector<float>& values, float most) {
  std::vector<T> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(), [most](float v) {
    return static_cast<T>(std::clamp(v, 0.0f, 1.0f) * most + 0.5f);
  });
  return out;
}

}  // namespace

std::string with_ending(const std::string& file, BakeFormat format) {
  if (format != BakeFormat::kExr) return file;
  return file.substr(0, file.rfind('.')) + ".exr";
}

Result<std::vector<std::uint8_t>> image_bytes(const BakeImage& image, BakeFormat format) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  const auto encode = [&](const auto* texels) {
    using T = std::remove_const_t<std::remove_pointer_t<decltype(texels)>>;
    const ImagePixels<T> pixels{image.width, image.height, image.channels, texels};
    return (*library)->encode(with_ending("a.png", format), pixels,
                              format == BakeFormat::kExr ? "zip" : kPngLevel);
  };
  switch (format) {
    case BakeFormat::kPng:
      return encode(rounded<std::uint8_t>(image.texels, 255).data());
    case BakeFormat::kPng16:
      return encode(rounded<std::uint16_t>(image.texels, 65535).data());
    case BakeFormat::kExr:
      return encode(image.texels.data());
  }
  return make_error(ErrorId::kInternal, "no such format");
}

}  // namespace mirage

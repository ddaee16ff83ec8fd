#include "client/host/png.h"

#include <png.h>

namespace mirage {

Result<void> write_png(const std::string& path, int width, int height,
                       const std::vector<std::uint8_t>& rgba) {
  // Alpha is left out, because it is the coverage by objects, not transparency.
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    rgb.insert(rgb.end(), rgba.begin() + static_cast<std::ptrdiff_t>(i),
               rgba.begin() + static_cast<std::ptrdiff_t>(i + 3));
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;
  if (png_image_write_to_file(&image, path.c_str(), 0, rgb.data(), 0, nullptr) == 0) {
    return make_error(ErrorId::kIo, "cannot write '" + path + "'", image.message);
  }
  return {};
}

}  // namespace mirage

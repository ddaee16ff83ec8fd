#include "client/host/png.h"

#include <OpenImageIO/imageio.h>

namespace mirage {

Result<void> write_png(const std::string& path, int width, int height,
                       const std::vector<std::uint8_t>& rgba) {
  // Alpha is the coverage by objects, not transparency: left out.
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    rgb.insert(rgb.end(), rgba.begin() + static_cast<std::ptrdiff_t>(i),
               rgba.begin() + static_cast<std::ptrdiff_t>(i + 3));
  }
  const std::unique_ptr<OIIO::ImageOutput> file = OIIO::ImageOutput::create(path);
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("png:compressionLevel", 1);
  if (!file || !file->open(path, spec) || !file->write_image(OIIO::TypeDesc::UINT8, rgb.data()) ||
      !file->close()) {
    return make_error(ErrorId::kIo, "cannot write '" + path + "'",
                      file ? file->geterror() : OIIO::geterror());
  }
  return {};
}

}  // namespace mirage

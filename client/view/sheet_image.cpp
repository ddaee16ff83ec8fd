#include "client/view/sheet_image.h"

#include <algorithm>

#include "modules/image_library.h"

namespace mirage {
namespace {

std::size_t pixels_of(const SheetImage& image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

}  // namespace

Result<SheetImage> read_sheet_image(const std::string& path) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  const ImageLibrary::Opened input = (*library)->open_file(path);
  if (!input) return make_error(ErrorId::kIo, "cannot read '" + path + "': " + input.error().text);
  const ImageShape shape = (*input)->shape();
  if (shape.width < 1 || shape.height < 1 || shape.channels < 3) {
    return make_error(ErrorId::kIo, "'" + path + "' is no colour image");
  }
  SheetImage out = white_sheet(shape.width, shape.height);
  std::vector<std::uint8_t> rgb(3 * pixels_of(out));
  if (const Result<void> read = (*input)->read_rows(0, shape.height, 3, rgb.data()); !read) {
    return make_error(ErrorId::kIo, "cannot read '" + path + "': " + read.error().text);
  }
  for (std::size_t i = 0; i < pixels_of(out); ++i) {
    std::copy_n(&rgb[3 * i], 3, &out.rgba[4 * i]);
  }
  return out;
}

SheetImage white_sheet(int width, int height) {
  SheetImage out{width, height, {}};
  out.rgba.assign(4 * pixels_of(out), 255);
  return out;
}

void paste(const SheetImage& image, int x, int y, SheetImage& sheet) {
  const auto bytes = [](int pixels) { return 4 * static_cast<std::ptrdiff_t>(pixels); };
  for (int row = 0; row < image.height; ++row) {
    const auto from = image.rgba.begin() + bytes(row) * image.width;
    std::copy_n(from, bytes(image.width),
                sheet.rgba.begin() + bytes(y + row) * sheet.width + bytes(x));
  }
}

Result<void> write_sheet_image(const SheetImage& image, const std::string& path) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  std::vector<std::uint8_t> rgb(3 * pixels_of(image));
  for (std::size_t i = 0; i < pixels_of(image); ++i) {
    std::copy_n(&image.rgba[4 * i], 3, &rgb[3 * i]);
  }
  const Result<void> written =
      (*library)->write_file(path, {image.width, image.height, 3, rgb.data()});
  if (written) return {};
  return make_error(ErrorId::kIo, "cannot write '" + path + "': " + written.error().text);
}

}  // namespace mirage

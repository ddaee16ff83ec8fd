#pragma once
// Sheet image: colour images from files, set side by side and written again.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct SheetImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< opaque, rows from the top
};

/// Reads the first three channels. Errors: kIo (unreadable, or no colour image), kModule.
Result<SheetImage> read_sheet_image(const std::string& path);

/// Returns an image of one colour.
SheetImage white_sheet(int width, int height);

/// Copies `image` into `sheet`, its left upper corner at (x, y). It fits.
void paste(const SheetImage& image, int x, int y, SheetImage& sheet);

/// Writes the colours; the name's ending tells the format. Errors: kIo, kModule.
Result<void> write_sheet_image(const SheetImage& image, const std::string& path);

}  // namespace mirage

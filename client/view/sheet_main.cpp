// mirage-sheet DIR OUT.png: a contact sheet of compared frames, one row each:
// Mirage | full render | difference.

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/cli.h"
#include "protocol/result.h"

namespace mirage {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> compared_frames(const std::string& directory) {
  std::vector<std::string> out;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("reference_", 0) == 0) out.push_back(name.substr(10));
  }
  std::sort(out.begin(), out.end());
  return out;
}

Result<void> make_sheet(const std::string& directory, const std::string& target) {
  const std::vector<std::string> frames = compared_frames(directory);
  if (frames.empty()) {
    return make_error(ErrorId::kUsage, "no compared frames in '" + directory + "'",
                      "mirage-view --reference N --out DIR writes them");
  }
  constexpr int kGap = 4;
  OIIO::ImageBuf sheet;
  for (std::size_t row = 0; row < frames.size(); ++row) {
    int column = 0;
    for (const char* kind : {"frame_", "reference_", "difference_"}) {
      const OIIO::ImageBuf image(directory + "/" + kind + frames[row]);
      const int w = image.spec().width, h = image.spec().height;
      if (row == 0 && column == 0) {
        const int rows = static_cast<int>(frames.size());
        sheet.reset(OIIO::ImageSpec(3 * w + 2 * kGap, rows * h + (rows - 1) * kGap, 3,
                                    OIIO::TypeDesc::UINT8));
        OIIO::ImageBufAlgo::fill(sheet, {1.0f, 1.0f, 1.0f});
      }
      OIIO::ImageBufAlgo::paste(sheet, column * (w + kGap), static_cast<int>(row) * (h + kGap), 0,
                                0, image);
      ++column;
    }
  }
  if (!sheet.write(target)) return make_error(ErrorId::kIo, "cannot write '" + target + "'");
  return {};
}

}  // namespace
}  // namespace mirage

int main(int argc, char** argv) {
  CLI::App app("Puts compared frames beside each other.", "mirage-sheet");
  std::string directory, target;
  app.add_option("DIR", directory, "frames of mirage-view --out")->required();
  app.add_option("OUT", target, "image to write")->required();
  mirage::add_conventions(app);
  if (const int code = mirage::parse_command_line(app, argc, argv); code >= 0) return code;
  const mirage::Result<void> made = mirage::make_sheet(directory, target);
  return made.ok() ? 0 : mirage::fail(made.error());
}

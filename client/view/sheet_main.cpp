// mirage-sheet DIR OUT.png: a contact sheet of compared frames, one row each:
// Mirage | full render | difference.
// mirage-sheet IMAGE IMAGE… OUT.png: images of one size beside each other, with the FLIP of each
// against the first.
// mirage-sheet --animate FPS DIR OUT.webp: all frames as a moving picture.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/view/animation.h"
#include "client/view/sheet_image.h"
#include "protocol/base/cli.h"
#include "protocol/base/resources.h"
#include "protocol/base/result.h"
#include "protocol/quality/flip.h"

namespace mirage {
namespace {

namespace fs = std::filesystem;

Error other_size(const std::string& path) {
  return make_error(ErrorId::kUsage, "'" + path + "' has another size than the first");
}

/// Returns the part after `kind` of the names of all images of that kind, sorted.
std::vector<std::string> frames_of(const std::string& directory, const std::string& kind) {
  std::vector<std::string> out;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(kind, 0) == 0) out.push_back(name.substr(kind.size()));
  }
  std::sort(out.begin(), out.end());
  return out;
}

// Gap between images of a sheet, pixels.
constexpr int kGap = 4;

Result<void> make_sheet(const std::string& directory, const std::string& target) {
  const std::vector<std::string> frames = frames_of(directory, "reference_");
  if (frames.empty()) {
    return make_error(ErrorId::kUsage, "no compared frames in '" + directory + "'",
                      "mirage-view --reference N --out DIR writes them");
  }
  SheetImage sheet;
  int w = 0, h = 0;
  for (std::size_t row = 0; row < frames.size(); ++row) {
    int column = 0;
    for (const char* kind : {"frame_", "reference_", "difference_"}) {
      const std::string path = directory + "/" + kind + frames[row];
      const Result<SheetImage> image = read_sheet_image(path);
      if (!image) return image.error();
      if (row == 0 && column == 0) {
        const int rows = static_cast<int>(frames.size());
        w = image->width;
        h = image->height;
        sheet = white_sheet(3 * w + 2 * kGap, rows * h + (rows - 1) * kGap);
      }
      if (image->width != w || image->height != h) return other_size(path);
      paste(*image, column * (w + kGap), static_cast<int>(row) * (h + kGap), sheet);
      ++column;
    }
  }
  return write_sheet_image(sheet, target);
}

Result<void> animate(const std::string& directory, double frames_per_second,
                     const std::string& target) {
  std::vector<std::string> images;
  for (const std::string& frame : frames_of(directory, "frame_")) {
    images.push_back(directory + "/frame_" + frame);
  }
  if (images.empty()) {
    return make_error(ErrorId::kUsage, "no frames in '" + directory + "'",
                      "mirage-view --out DIR writes them");
  }
  return write_animation(images, frames_per_second, target);
}

Result<void> compare_images(const std::vector<std::string>& paths, const std::string& target) {
  SheetImage sheet, first;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    Result<SheetImage> image = read_sheet_image(paths[i]);
    if (!image) return image.error();
    const int w = image->width, h = image->height, count = static_cast<int>(paths.size());
    if (i == 0) {
      first = *image;
      sheet = white_sheet(count * w + (count - 1) * kGap, h);
    }
    if (w != first.width || h != first.height) return other_size(paths[i]);
    paste(*image, static_cast<int>(i) * (w + kGap), 0, sheet);
    const auto size = [](int v) { return static_cast<std::uint32_t>(v); };
    const std::optional<FlipMap> map =
        flip_map({size(w), size(h), first.rgba.data()}, {size(w), size(h), image->rgba.data()});
    const std::optional<double> flip = map ? flip_mean(*map) : std::nullopt;
    if (i > 0) std::printf("%s flip=%.4f\n", paths[i].c_str(), flip.value_or(0.0));
  }
  return write_sheet_image(sheet, target);
}

int run(int argc, char** argv) {
  CLI::App app("Puts compared frames beside each other.", "mirage-sheet");
  app.footer(
      "Example: mirage-sheet frames sheet.png\n         mirage-sheet truth.png drawn.png "
      "beside.png");
  app.option_defaults()->group("Pictures");
  std::vector<std::string> paths;
  app.add_option(
         "PATHS", paths,
         "a folder of mirage-view --out, or images to compare with the first of them; then the "
         "image to write")
      ->required()
      ->expected(2, 64);
  double animated = 0;
  app.add_option("--animate", animated,
                 "write an animated WebP of all frames instead, at so many frames per second")
      ->check(CLI::Range(1.0, 100.0));
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  const std::string target = paths.back();
  paths.pop_back();
  const Result<void> made = animated > 0        ? animate(paths.front(), animated, target)
                            : paths.size() == 1 ? make_sheet(paths.front(), target)
                                                : compare_images(paths, target);
  return made.ok() ? 0 : fail(made.error());
}

}  // namespace
}  // namespace mirage

int main(int argc, char** argv) {
  return mirage::run_program([&] { return mirage::run(argc, argv); });
}

#include "server/scene/environment/environment_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "modules/image_library.h"

namespace mirage {
namespace {

constexpr int kMostEdge = 8192;  // 16k would take seconds to decode and adds nothing
constexpr int kWidth = 1024, kHeight = 512;
constexpr float kBrightest = 65408.0f;  // largest value of a probe's texels
constexpr int kBandRows = 64;

// Sums the pixels that fall into each texel of the reduced image.
class Reducer {
 public:
  Reducer(int width, int height)
      : width_(width),
        height_(height),
        out_{std::min(width, kWidth), std::min(height, kHeight), {}},
        sums_(static_cast<std::size_t>(out_.width) * static_cast<std::size_t>(out_.height)),
        counts_(sums_.size()) {}

  void add_row(int y, const float* pixels, int channels) {
    const auto row = static_cast<std::size_t>(std::int64_t{y} * out_.height / height_) *
                     static_cast<std::size_t>(out_.width);
    for (int x = 0; x < width_; ++x, pixels += channels) {
      const glm::vec3 c =
          channels < 3 ? glm::vec3(pixels[0]) : glm::vec3(pixels[0], pixels[1], pixels[2]);
      const std::size_t at = row + static_cast<std::size_t>(std::int64_t{x} * out_.width / width_);
      sums_[at] += checked(c);
      ++counts_[at];
    }
  }

  Equirect take(std::vector<std::string>& warnings) {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      out_.texels.push_back(sums_[i] / static_cast<float>(std::max(counts_[i], 1u)));
    }
    if (replaced_ > 0) {
      warnings.push_back("environment: " + std::to_string(replaced_) +
                         " pixels that are no colour (NaN, negative, beyond 65408) replaced");
    }
    return std::move(out_);
  }

 private:
  glm::vec3 checked(glm::vec3 c) {
    bool bad = false;
    for (int i = 0; i < 3; ++i) {
      const float v = c[i];
      if (v >= 0 && v <= kBrightest) continue;
      bad = true;
      c[i] = v > kBrightest ? kBrightest : 0.0f;  // NaN becomes black, too
    }
    replaced_ += bad ? 1 : 0;
    return c;
  }

  int width_, height_;
  Equirect out_;
  std::vector<glm::vec3> sums_;
  std::vector<std::uint32_t> counts_;
  std::size_t replaced_ = 0;
};

Result<Equirect> read(const std::string& path, std::vector<std::string>& warnings) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  const ImageLibrary::Opened input = (*library)->open_file(path);
  if (!input) {
    return make_error(ErrorId::kSceneFormat, input.error().text, "a .hdr or .exr file");
  }
  const ImageShape shape = (*input)->shape();
  const int w = shape.width, h = shape.height, channels = shape.channels;
  if (w < 1 || h < 1 || shape.depth > 1 || channels < 1) {
    return make_error(ErrorId::kSceneFormat, "an image without pixels");
  }
  if (w > kMostEdge || h > kMostEdge) {
    return make_error(ErrorId::kSceneLimit,
                      std::to_string(w) + " x " + std::to_string(h) + " pixels are too many",
                      "oiiotool FILE --resize 4096x2048 -o SMALLER");
  }
  const int taken = std::min(channels, 3);
  const int rows = shape.tile_height > 0 ? shape.tile_height : kBandRows;
  if (rows > kMostEdge || shape.tile_width > 2 * kMostEdge) {
    return make_error(ErrorId::kSceneLimit, "its tiles are too large");
  }
  std::vector<float> band(static_cast<std::size_t>(w) * static_cast<std::size_t>(rows * taken));
  Reducer reducer(w, h);
  for (int y = 0; y < h; y += rows) {
    const int end = std::min(y + rows, h);
    if (const Result<void> read = (*input)->read_rows(y, end, taken, band.data()); !read) {
      return make_error(ErrorId::kSceneFormat, read.error().text);
    }
    for (int i = y; i < end; ++i) {
      reducer.add_row(i, band.data() + static_cast<std::ptrdiff_t>(i - y) * w * taken, taken);
    }
  }
  if (w != 2 * h) {
    warnings.push_back("environment: " + std::to_string(w) + " x " + std::to_string(h) +
                       " pixels are not 2:1; taken as all directions all the same");
  }
  return reducer.take(warnings);
}

}  // namespace

Result<Equirect> read_environment(const std::string& path, std::vector<std::string>& warnings) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) {
    return make_error(ErrorId::kSceneMissing, "no environment file '" + path + "'",
                      "--environment FILE.hdr, FILE.exr, builtin:studio, builtin:sky or none");
  }
  Result<Equirect> image = read(path, warnings);
  if (image) return image;
  const Error& error = image.error();
  return make_error(error.id, "environment " + path + ": " + error.text, error.hint);
}

Result<void> write_environment(const Equirect& image, const std::string& path) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  const ImagePixels<float> pixels{image.width, image.height, 3, &image.texels.data()->x};
  const Result<void> written = (*library)->write_file(path, pixels);
  if (written) return {};
  return make_error(ErrorId::kIo, "cannot write '" + path + "': " + written.error().text);
}

}  // namespace mirage

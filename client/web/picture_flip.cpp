// Picture FLIP: the difference of two pictures, which the worker computes for the page because it
// takes long. socket_worker.js calls the exports; returned memory belongs to this side, and is
// valid until the next call.

#include <emscripten.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "protocol/quality/flip.h"

namespace mirage {
namespace {

constexpr std::uint32_t kWorstOfHeight = 16;  // edges of the worst square in a picture's height

/// The last measurement of picture_flip().
struct Compared {
  std::array<double, 6> flip{-1, -1, -1, -1, -1, -1};
  std::vector<std::uint8_t> heat;  // RGBA
};

Compared& compared() {
  static Compared one;
  return one;
}

// Returns the pixels that objects cover by half or more.
Mask covered(const ImageView& picture) {
  Mask out{picture.width, picture.height, std::vector<std::uint8_t>(picture.pixels())};
  for (std::size_t i = 0; i < picture.pixels(); ++i) out.inside[i] = picture.rgba[4 * i + 3] >= 128;
  return out;
}

}  // namespace
}  // namespace mirage

extern "C" {

/// Measures two RGBA pictures; the reference's alpha is its coverage by objects. Returns three FLIP
/// values: the mean of the picture, the mean where objects are, and what 99 % of the pixels there
/// stay within; then the place of the worst square (shares of width and height, right and down),
/// and its mean. < 0: there is none.
EMSCRIPTEN_KEEPALIVE const double* picture_flip(const std::uint8_t* reference,
                                                const std::uint8_t* test, std::uint32_t width,
                                                std::uint32_t height) {
  mirage::Compared& out = mirage::compared() = {};
  const mirage::ImageView truth{width, height, reference};
  const std::optional<mirage::FlipMap> map = mirage::flip_map(truth, {width, height, test});
  if (!map) return out.flip.data();
  const mirage::Mask mask = mirage::covered(truth);
  const mirage::PicturePlace worst =
      mirage::flip_worst_place(*map, std::max(1U, height / mirage::kWorstOfHeight))
          .value_or(mirage::PicturePlace{-1, -1, -1});
  out.flip = {mirage::flip_mean(*map).value_or(-1),
              mirage::flip_mean(*map, mask).value_or(-1),
              mirage::flip_quantile(*map, mask, 0.99).value_or(-1),
              worst.x,
              worst.y,
              worst.flip};
  out.heat = mirage::heat_map(*map);
  return out.flip.data();
}
/// Returns the map of the last measurement as RGBA; nullptr: there is none.
EMSCRIPTEN_KEEPALIVE const std::uint8_t* picture_heat() {
  const mirage::Compared& last = mirage::compared();
  return last.heat.empty() ? nullptr : last.heat.data();
}

}  // extern "C"

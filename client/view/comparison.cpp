#include "client/view/comparison.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdlib>

#include "client/draw/geometric_error.h"
#include "client/frame/planned_frame.h"
#include "client/frame/reference_frame.h"
#include "client/host/png.h"
#include "client/view/session_stats.h"
#include "protocol/quality/flip.h"
#include "protocol/quality/metrics.h"

namespace mirage {
namespace {

Result<void> write_pictures(const Comparison::Frame& frame, const std::string& out_dir) {
  const std::vector<std::uint8_t>& truth = frame.reference.rgba;
  std::vector<std::uint8_t> difference(frame.drawn.size(), 255);
  for (std::size_t i = 0; i < frame.drawn.size(); ++i) {
    if (i % 4 == 3) continue;
    const int d = std::abs(int{frame.drawn[i]} - int{truth[i]});
    difference[i] = static_cast<std::uint8_t>(std::min(255, d * 2));
  }
  const auto name = [&](const char* kind) {
    return fmt::format("{}/{}_{:05}.png", out_dir, kind, frame.number - 1);
  };
  const int w = static_cast<int>(frame.planned.camera.width),
            h = static_cast<int>(frame.planned.camera.height);
  if (Result<void> r = write_png(name("reference"), w, h, truth); !r) return r;
  if (Result<void> r = write_png(name("difference"), w, h, difference); !r) return r;
  const ImageView test{frame.planned.camera.width, frame.planned.camera.height, frame.drawn.data()};
  const std::optional<FlipMap> map = flip_map({test.width, test.height, truth.data()}, test);
  return map ? write_png(name("flip"), w, h, heat_map(*map)) : Result<void>{};
}

}  // namespace

Result<void> Comparison::add(const Frame& frame, SessionStats& stats, const std::string& out_dir) {
  const std::uint32_t w = frame.reference.width, h = frame.reference.height;
  const ImageView truth{w, h, frame.reference.rgba.data()};
  const ImageView test{w, h, frame.drawn.data()};
  stats.add_comparison(measure_images(truth, test));
  if (before_.number + 1 == frame.number && before_.drawn.size() == frame.drawn.size()) {
    const ImageView truth_before{w, h, before_.truth.data()};
    const ImageView test_before{w, h, before_.drawn.data()};
    stats.add_flicker(flicker(truth_before, test_before, truth, test));
  }
  before_ = {frame.number, frame.drawn, frame.reference.rgba};
  const double s = frame.supersample;
  add_geometric_error(frame.reference, (std::floor(s / 2) + 0.5) / s, frame.planned,
                      stats.geometric());
  return out_dir.empty() ? Result<void>{} : write_pictures(frame, out_dir);
}

}  // namespace mirage

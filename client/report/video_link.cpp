#include "client/report/video_link.h"

#include <algorithm>
#include <cmath>

namespace mirage {

int first_video_frame(const NetModel& net, double fps) {
  return static_cast<int>(std::ceil(2 * net.rtt_ms * 1e-3 * fps));
}

std::vector<std::int64_t> video_arrivals(const std::vector<std::size_t>& bytes, int first,
                                         const VideoTiming& timing, const NetModel& net) {
  NetDelays delays(net);
  std::int64_t down_free = 0, up_free = 0, last = 0;
  std::vector<std::int64_t> out;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto posed = std::llround((first + static_cast<double>(i)) * 1e6 / timing.fps);
    up_free = std::max<std::int64_t>(posed, up_free) + delays.transmission_us(kPoseBytes);
    const std::int64_t asked = up_free + delays.one_way_us();
    const std::int64_t ready = asked + std::llround(1e3 * (timing.render_ms + timing.encode_ms));
    down_free = std::max(ready, down_free) + delays.transmission_us(bytes[i] + kVideoFraming);
    last = std::max(last, down_free + delays.one_way_us());  // frames arrive in order
    out.push_back(last + std::llround(1e3 * timing.decode_ms));
  }
  return out;
}

std::vector<std::uint8_t> timewarp(const std::vector<std::uint8_t>& shown, const Camera& then,
                                   const Camera& now, std::size_t& outside) {
  outside = 0;
  const int w = static_cast<int>(now.width), h = static_cast<int>(now.height);
  std::vector<std::uint8_t> out(shown.size());
  const double f = now.focal_px();
  const glm::dvec3 right = now.right(), up = now.up(), forward = now.forward();
  const auto texel = [&](int x, int y) {
    const std::size_t row = static_cast<std::size_t>(std::clamp(y, 0, h - 1));
    return &shown[4 * (row * now.width + static_cast<std::size_t>(std::clamp(x, 0, w - 1)))];
  };
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      std::uint8_t* to =
          &out[4 * (static_cast<std::size_t>(y) * now.width + static_cast<std::size_t>(x))];
      const glm::dvec3 ray =
          forward + right * ((x + 0.5 - 0.5 * w) / f) - up * ((y + 0.5 - 0.5 * h) / f);
      const glm::dvec3 at = then.pixel_from_relative(ray);
      if (!(at.z > 0) || !(at.x >= 0 && at.x <= w && at.y >= 0 && at.y <= h)) {
        ++outside;
        to[0] = to[1] = to[2] = 0;
        to[3] = 255;
        continue;
      }
      const double px = at.x - 0.5, py = at.y - 0.5;
      const int x0 = static_cast<int>(std::floor(px)), y0 = static_cast<int>(std::floor(py));
      const double fx = px - x0, fy = py - y0;
      for (int c = 0; c < 4; ++c) {
        const double top = (1 - fx) * texel(x0, y0)[c] + fx * texel(x0 + 1, y0)[c];
        const double low = (1 - fx) * texel(x0, y0 + 1)[c] + fx * texel(x0 + 1, y0 + 1)[c];
        to[c] = static_cast<std::uint8_t>(std::lround((1 - fy) * top + fy * low));
      }
    }
  }
  return out;
}

}  // namespace mirage

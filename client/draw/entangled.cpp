#include "client/draw/entangled.h"

#include <algorithm>

namespace mirage {

std::vector<std::uint32_t> entangled(const std::vector<DrawnImpostor>& impostors,
                                     const SceneView& scene) {
  std::vector<std::uint32_t> by_x, out;
  double largest = 0;
  for (const DrawnImpostor& drawn : impostors) {
    by_x.push_back(drawn.instance);
    largest = std::max(largest, double{scene.instances[drawn.instance].radius});
  }
  const auto x = [&](std::uint32_t i) { return scene.instances[i].center.x; };
  std::sort(by_x.begin(), by_x.end(), [&](auto a, auto b) { return x(a) < x(b); });
  for (std::size_t a = 0; a < by_x.size(); ++a) {
    const InstanceView& one = scene.instances[by_x[a]];
    for (std::size_t b = a + 1; b < by_x.size() && x(by_x[b]) <= one.center.x + largest; ++b) {
      if (by_x[a] == by_x[b]) continue;  // an image and the one that it fades into
      const InstanceView& other = scene.instances[by_x[b]];
      const double reach = std::max(one.radius, other.radius);
      if (glm::length(one.center - other.center) < reach) {
        out.insert(out.end(), {by_x[a], by_x[b]});
      }
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace mirage

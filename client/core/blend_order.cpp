#include "client/core/blend_order.h"

#include <algorithm>
#include <cmath>

#include "protocol/need_mask.h"
#include "protocol/stable_math.h"

namespace mirage {
namespace {

constexpr double kAllAround = 3.141592653589793;

// A bounding sphere as the eye sees it.
struct Seen {
  glm::dvec3 direction;
  double half_angle = 0;  // from inside: all around
};

Seen seen_from(const glm::dvec3& eye, const InstanceView& view) {
  const glm::dvec3 to_center = view.center - eye;
  const double distance = std::max(glm::length(to_center), 1e-9);
  const double sine = view.radius / distance;
  return {to_center / distance, sine < 1 ? std::asin(sine) : kAllAround};
}

bool overlap(const Seen& a, const Seen& b) {
  return angle_between(a.direction, b.direction) < a.half_angle + b.half_angle;
}

}  // namespace

double blend_distance(const DrawnImpostor& drawn, const SceneView& scene, const glm::dvec3& eye) {
  const InstanceView& view = scene.instances[drawn.instance];
  const double distance = glm::length(view.center - eye);
  const bool seen_through = drawn.tile && (scene.objects[view.object].needs & kNeedBlend);
  if (!seen_through) return distance + view.radius;
  const TileRecord& tile = *drawn.tile;
  const double before = tile.capture.distance - double{tile.measure.depth_min};
  return distance - before * double{view.world_from_object.scale};
}

void sort_for_blending(std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye) {
  const bool through =
      std::any_of(impostors.begin(), impostors.end(), [&](const DrawnImpostor& drawn) {
        return scene.objects[scene.instances[drawn.instance].object].needs & kNeedBlend;
      });
  if (!through) return;  // as they come: by far sides
  std::vector<std::pair<double, std::size_t>> order(impostors.size());
  for (std::size_t i = impostors.size(); i-- > 0;) {
    const bool fades = i + 1 < order.size() && impostors[i].instance == impostors[i + 1].instance;
    order[i] = {fades ? order[i + 1].first : blend_distance(impostors[i], scene, eye), i};
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<DrawnImpostor> sorted;
  sorted.reserve(impostors.size());
  for (const auto& [distance, i] : order) sorted.push_back(std::move(impostors[i]));
  impostors = std::move(sorted);
}

BlendOrder blend_order(const std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye) {
  std::vector<std::pair<Seen, double>> relief;
  for (const DrawnImpostor& drawn : impostors) {
    if (drawn.method != DrawMethod::kDepth) continue;
    relief.emplace_back(seen_from(eye, scene.instances[drawn.instance]),
                        blend_distance(drawn, scene, eye));
  }
  BlendOrder out;
  for (const DrawnImpostor& drawn : impostors) {
    if (drawn.method == DrawMethod::kDepth) continue;
    const Seen flat = seen_from(eye, scene.instances[drawn.instance]);
    const double distance = blend_distance(drawn, scene, eye);
    const bool over = std::any_of(relief.begin(), relief.end(), [&](const auto& r) {
      return r.second > distance && overlap(r.first, flat);
    });
    (over ? out.over_relief : out.under_relief).push_back(&drawn);
  }
  return out;
}

}  // namespace mirage

#include "client/core/blend_order.h"

#include <algorithm>
#include <cmath>

#include "protocol/stable_math.h"

namespace mirage {
namespace {

constexpr double kAllAround = 3.141592653589793;

// A bounding sphere as the eye sees it.
struct Seen {
  glm::dvec3 direction;
  double half_angle = 0;  // from inside: all around
  double far_side = 0;    // m
};

Seen seen_from(const glm::dvec3& eye, const InstanceView& view) {
  const glm::dvec3 to_center = view.center - eye;
  const double distance = std::max(glm::length(to_center), 1e-9);
  const double sine = view.radius / distance;
  return {to_center / distance, sine < 1 ? std::asin(sine) : kAllAround, distance + view.radius};
}

bool overlap(const Seen& a, const Seen& b) {
  return angle_between(a.direction, b.direction) < a.half_angle + b.half_angle;
}

}  // namespace

BlendOrder blend_order(const std::vector<DrawnImpostor>& impostors, const SceneView& scene,
                       const glm::dvec3& eye) {
  std::vector<Seen> relief;
  for (const DrawnImpostor& drawn : impostors) {
    if (drawn.method == DrawMethod::kDepth)
      relief.push_back(seen_from(eye, scene.instances[drawn.instance]));
  }
  BlendOrder out;
  for (const DrawnImpostor& drawn : impostors) {
    if (drawn.method == DrawMethod::kDepth) continue;
    const Seen flat = seen_from(eye, scene.instances[drawn.instance]);
    const bool over = std::any_of(relief.begin(), relief.end(), [&](const Seen& r) {
      return r.far_side > flat.far_side && overlap(r, flat);
    });
    (over ? out.over_relief : out.under_relief).push_back(&drawn);
  }
  return out;
}

}  // namespace mirage

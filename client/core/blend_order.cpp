#include "client/core/blend_order.h"

#include <algorithm>

namespace mirage {
namespace {

// A bounding sphere as the eye sees it.
struct Seen {
  glm::dvec3 direction;
  double sine = 0;      // of the half angle; 1 and more from inside
  double far_side = 0;  // m
};

Seen seen_from(const glm::dvec3& eye, const InstanceView& view) {
  const glm::dvec3 to_center = view.center - eye;
  const double distance = std::max(glm::length(to_center), 1e-9);
  return {to_center / distance, view.radius / distance, distance + view.radius};
}

// Chords are shorter than arcs: wide spheres are taken to overlap a little early.
bool overlap(const Seen& a, const Seen& b) {
  return glm::length(a.direction - b.direction) < a.sine + b.sine;
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

#include "protocol/impostor/instance_group.h"

#include <algorithm>
#include <cmath>

namespace mirage {

GroupBounds GroupBounds::around(const glm::dvec3& low, const glm::dvec3& high) {
  GroupBounds out;
  out.center = 0.5 * (low + high);
  const glm::dvec3 half = 0.5 * (high - low);
  const double slack = 1e-6 * glm::length(half) + 1e-12 * glm::length(out.center);
  out.half = glm::vec3(half + slack);
  return out;
}

void GroupBounds::set_mean_color(const glm::vec3& linear) {
  for (int c = 0; c < 3; ++c) {
    mean_color[c] = std::round(std::clamp(linear[c], 0.0f, 1.0f) * 255.0f) / 255.0f;
  }
}

double tolerance(Importance importance) {
  switch (importance) {
    case Importance::kScenery:
      return 2;
    case Importance::kImportant:
      return 0.5;
    case Importance::kNormal:
      break;
  }
  return 1;
}

ObjectDescription group_description(const GroupBounds& bounds) {
  ObjectDescription out;
  out.group = true;
  out.box_min = -bounds.half;
  out.box_max = bounds.half;
  out.radius = glm::length(bounds.half) * 1.00001f;
  out.mean_color = bounds.mean_color;
  out.needs = bounds.needs;
  for (int corner = 0; corner < 8; ++corner) {
    out.hull.vertices.push_back(
        bounds.half * glm::vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
  }
  // Triangles are counter-clockwise from outside; the bits of a corner's index are x, y, z.
  out.hull.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                      2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  out.hull.parallax.assign(out.hull.vertices.size(), 0.0f);
  return out;
}

// An image lasts while the eye stays within path = 1.6 tau (d - r)^2 / (f s r). The depth share s
// is gap / clamp(hole share * f r / d, 1, 8) for tau up to 1 px; a larger tau only makes it last
// longer. The result solves this for d with s at both ends of the clamp, and with s as it is
// between them.
double open_distance(const OpenRule& rule, double radius) {
  const double r = radius;
  const double k =
      kGroupLifeS * rule.speed_mps * rule.focal_px * kTypicalGap / ((1 + kLeadShare) * rule.tau_px);
  const double large = r + std::sqrt(k * r / kHoleTolerance);
  const double small = r + std::sqrt(k * r);
  const double holes_px = kHoleShare * std::min(1.0, 1.0 / rule.tau_px) * rule.focal_px;
  const double between = 2 * r + k / holes_px;
  return rule.margin * std::max({kGroupRadii * r, large, std::min(small, between)});
}

}  // namespace mirage

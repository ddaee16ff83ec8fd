#include "tests/server/bake/arrows.h"

#include <algorithm>
#include <limits>

namespace mirage {
namespace {

struct Bar {
  glm::dvec3 low, high, color;  // in radii, from the centre
};
// No two sides are alike, so that no ray meets an edge by symmetry.
const Bar kBars[] = {
    {{0, -.0713, -.0627}, {kRedEnd, .0671, .0739}, {1, 0, 0}},
    {{-.0643, 0, -.0769}, {.0717, kGreenEnd, .0691}, {0, 1, 0}},
    {{-.0753, -.0659, 0}, {.0633, .0727, kBlueEnd}, {0, 0, 1}},
};
const glm::dvec3 kBall{-.2037, .1019, -.1523};
constexpr double kBallRadius = .3;
const glm::dvec3 kBallColor{.8, .7, .6};

void keep_nearer(std::optional<SurfaceHit>& best, double& best_way, double way, SurfaceHit hit) {
  if (way >= best_way) return;
  best_way = way;
  best = hit;
}

}  // namespace

std::optional<SurfaceHit> hit_arrows(const glm::dvec3& origin, const glm::dvec3& toward) {
  const glm::dvec3 o = (origin - kArrowsCenter) / kArrowsRadius, d = -toward;
  std::optional<SurfaceHit> best;
  double best_way = std::numeric_limits<double>::infinity();
  for (const auto& bar : kBars) {
    double in = -1e30, out = 1e30;
    int side = 0;
    for (int a = 0; a < 3; ++a) {
      if (d[a] == 0) {
        if (o[a] < bar.low[a] || o[a] > bar.high[a]) out = -1e30;
        continue;
      }
      const double p = (bar.low[a] - o[a]) / d[a], q = (bar.high[a] - o[a]) / d[a];
      if (std::min(p, q) > in) in = std::min(p, q), side = a;
      out = std::min(out, std::max(p, q));
    }
    if (in > out || in < 0) continue;
    glm::dvec3 normal(0);
    normal[side] = d[side] > 0 ? -1 : 1;
    keep_nearer(best, best_way, in, {o + d * in, normal, bar.color});
  }
  const glm::dvec3 to = o - kBall;
  const double b = dot(to, d), c = dot(to, to) - kBallRadius * kBallRadius;
  if (const double root = b * b - c; root > 0 && -b - std::sqrt(root) > 0) {
    const double way = -b - std::sqrt(root);
    const glm::dvec3 point = o + d * way;
    keep_nearer(best, best_way, way, {point, (point - kBall) / kBallRadius, kBallColor});
  }
  if (best) best->point = best->point * kArrowsRadius + kArrowsCenter;
  return best;
}

double distance_to_arrows(const glm::dvec3& point) {
  const glm::dvec3 p = (point - kArrowsCenter) / kArrowsRadius;
  double nearest = std::abs(glm::distance(p, kBall) - kBallRadius);
  for (const auto& bar : kBars) {
    const glm::dvec3 q = glm::max(bar.low - p, p - bar.high);  // below 0: inside
    const double outside = glm::length(glm::max(q, 0.0));
    nearest = std::min(nearest, outside > 0 ? outside : -std::max({q.x, q.y, q.z}));
  }
  return nearest * kArrowsRadius;
}

BakeMaster arrows_master(BakeLayout layout, int grid, int tile, const RollRule& roll) {
  BakeMaster master;
  master.layout = layout;
  master.roll = roll;
  master.grid = grid;
  master.tile = tile;
  master.center = kArrowsCenter;
  master.radius = kArrowsRadius;
  master.clear();
  for (int j = 0; j < grid; ++j) {
    for (int i = 0; i < grid; ++i) {
      const FrameBasis b = master.basis(i, j);
      for (int t = 0; t < tile * tile; ++t) {
        const double x = (t % tile + .5) / tile * 2 - 1, y = 1 - (t / tile + .5) / tile * 2;
        const glm::dvec3 plane = (b.right * x + b.up * y) * kArrowsRadius + kArrowsCenter;
        const auto hit = hit_arrows(plane + b.toward * (2 * kArrowsRadius), b.toward);
        if (!hit) continue;
        const std::size_t at = master.first(i, j) + t;
        master.color[at] = glm::vec4(hit->color, 1);
        master.normal[at] = hit->normal;
        master.depth[at] = float(dot(hit->point - kArrowsCenter, b.toward) / kArrowsRadius);
        master.orm[at] = {.9f, .25f, .75f};
      }
    }
  }
  return master;
}

}  // namespace mirage

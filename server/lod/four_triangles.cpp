#include "server/lod/four_triangles.h"

#include <algorithm>

namespace mirage {
namespace {

using Lanes = FourTriangles::Lanes;
using Point = std::array<Lanes, 3>;

Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Lanes dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Lanes at_least_tiny(const Lanes& a) { return a < 1e-30f ? Lanes{} + 1e-30f : a; }

}  // namespace

glm::vec3 closest_on_triangle(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b,
                              const glm::vec3& c) {
  const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const glm::vec3 bp = p - b;
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / std::max(d1 - d3, 1e-30f));
  const glm::vec3 cp = p - c;
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / std::max(d2 - d6, 1e-30f));
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return b + (c - b) * ((d4 - d3) / std::max((d4 - d3) + (d5 - d6), 1e-30f));
  }
  const float sum = va + vb + vc;
  if (!(sum > 0)) return a;
  return a + ab * (vb / sum) + ac * (vc / sum);
}

// Computes the cases of closest_on_triangle() for all four triangles, from the last case to the
// first, so that the first case that holds wins.
FourTriangles::Nearest FourTriangles::nearest(const glm::vec3& p) const {
  const Point& a = corners_[0];
  const Point &b = corners_[1], &c = corners_[2];
  const Point at = {Lanes{} + p.x, Lanes{} + p.y, Lanes{} + p.z};
  const Point ab = b - a, ac = c - a, ap = at - a, bp = at - b, cp = at - c, bc = c - b;
  const Lanes d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp),
              d5 = dot(ab, cp), d6 = dot(ac, cp);
  const Lanes vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  const Lanes sum = va + vb + vc;
  const auto flat = sum > 0;
  const Lanes inside_b = vb / sum, inside_c = vc / sum;
  const auto on_bc = (va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0);
  const Lanes along_bc = (d4 - d3) / at_least_tiny((d4 - d3) + (d5 - d6));
  const auto on_ac = (vb <= 0) & (d2 >= 0) & (d6 <= 0);
  const Lanes along_ac = d2 / at_least_tiny(d2 - d6);
  const auto at_c = (d6 >= 0) & (d5 <= d6);
  const auto on_ab = (vc <= 0) & (d1 >= 0) & (d3 <= 0);
  const Lanes along_ab = d1 / at_least_tiny(d1 - d3);
  const auto at_b = (d3 >= 0) & (d4 <= d3);
  const auto at_a = (d1 <= 0) & (d2 <= 0);
  Nearest out;
  for (std::size_t i = 0; i < 3; ++i) {
    Lanes point = flat ? a[i] + ab[i] * inside_b + ac[i] * inside_c : a[i];
    point = on_bc ? b[i] + bc[i] * along_bc : point;
    point = on_ac ? a[i] + ac[i] * along_ac : point;
    point = at_c ? c[i] : point;
    point = on_ab ? a[i] + ab[i] * along_ab : point;
    point = at_b ? b[i] : point;
    out.point[i] = at_a ? a[i] : point;
  }
  const Point off = out.point - at;
  out.distance2 = dot(off, off);
  return out;
}

}  // namespace mirage

#include "server/bake/lattice.h"

#include <algorithm>
#include <cmath>

namespace mirage {
namespace {

constexpr double kTau = 6.283185307179586;

double sign_of(double v) { return v < 0 ? -1.0 : 1.0; }

// Folds the lower half of an octahedron over the corners of the square, or back.
glm::dvec2 folded(const glm::dvec2& p) {
  return {sign_of(p.x) * (1 - std::abs(p.y)), sign_of(p.y) * (1 - std::abs(p.x))};
}

}  // namespace

std::string_view name_of(BakeLayout layout) {
  switch (layout) {
    case BakeLayout::kHemi:
      return "hemi";
    case BakeLayout::kOctahedral:
      return "octahedral";
    case BakeLayout::kRing:
      return "ring";
  }
  return "";
}

std::optional<BakeLayout> layout_of(std::string_view name) {
  for (const auto layout : {BakeLayout::kHemi, BakeLayout::kOctahedral, BakeLayout::kRing}) {
    if (name == name_of(layout)) return layout;
  }
  return std::nullopt;
}

glm::dvec3 frame_direction(BakeLayout layout, int grid, int i, int j) {
  if (layout == BakeLayout::kRing) {
    const double angle = kTau * (j * grid + i) / (double{1} * grid * grid);
    return {std::sin(angle), 0, std::cos(angle)};
  }
  const double u = double(i) / (grid - 1), v = double(j) / (grid - 1);
  if (layout == BakeLayout::kHemi) {
    const double x = u - v, z = u + v - 1;
    return glm::normalize(glm::dvec3(x, 1 - std::abs(x) - std::abs(z), z));
  }
  glm::dvec2 p(2 * u - 1, 2 * v - 1);
  const double up = 1 - std::abs(p.x) - std::abs(p.y);
  if (up < 0) p = folded(p);
  return glm::normalize(glm::dvec3(p.x, up, p.y));
}

glm::dvec2 lattice_place(BakeLayout layout, int grid, const glm::dvec3& direction) {
  glm::dvec3 d = direction;
  if (layout == BakeLayout::kHemi) d.y = std::max(d.y, 0.0);
  const double l = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  glm::dvec2 p = l > 0 ? glm::dvec2(d.x, d.z) / l : glm::dvec2(0);
  if (layout == BakeLayout::kHemi) {
    p = glm::dvec2(p.y + p.x, p.y - p.x);
  } else if (d.y < 0) {
    p = folded(p);
  }
  return glm::clamp((p + 1.0) / 2.0, 0.0, 1.0) * double(grid - 1);
}

FrameBasis frame_basis(const RollRule& rule, const glm::dvec3& direction) {
  const bool polar = std::abs(direction.y) > rule.polar_from;
  const glm::dvec3 upward = polar ? rule.polar_up : glm::dvec3(0, 1, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(upward, direction));
  return {right, glm::cross(direction, right), direction};
}

FrameBlend frame_blend(BakeLayout layout, int grid, const glm::dvec3& direction) {
  if (layout == BakeLayout::kRing) {
    const int all = grid * grid;
    const double turn = std::atan2(direction.x, direction.z) / kTau;
    const double at = (turn - std::floor(turn)) * all;
    const int first = int(at) % all, second = (first + 1) % all;
    const double f = at - std::floor(at);
    const glm::ivec2 a(first % grid, first / grid), b(second % grid, second / grid);
    return {{a, b, b}, {1 - f, f, 0}};
  }
  const glm::dvec2 at = lattice_place(layout, grid, direction);
  const glm::ivec2 base = glm::min(glm::ivec2(at), glm::ivec2(grid - 2));
  const glm::dvec2 f = at - glm::dvec2(base);
  const glm::ivec2 middle = f.x > f.y ? glm::ivec2(1, 0) : glm::ivec2(0, 1);
  return {{base, base + middle, base + 1},
          {std::min(1 - f.x, 1 - f.y), std::abs(f.x - f.y), std::min(f.x, f.y)}};
}

}  // namespace mirage

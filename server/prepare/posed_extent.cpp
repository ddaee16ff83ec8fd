#include "server/prepare/posed_extent.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace mirage {
namespace {

constexpr std::size_t kBlock = 64;
constexpr double kRounding = 1e-6;  // relative rounding of floats over a few operations

typedef float Lanes __attribute__((vector_size(16)));

/// Four points, one lane each: one instruction for four numbers.
struct FourPoints {
  Lanes at[3];

  FourPoints() = default;
  explicit FourPoints(const glm::vec3* points) {
    Lanes a, b, c;  // x y z x | y z x y | z x y z
    static_assert(3 * sizeof(Lanes) == 4 * sizeof(glm::vec3));
    std::memcpy(&a, &points[0].x, sizeof(a));
    std::memcpy(&b, &points[1].y, sizeof(b));
    std::memcpy(&c, &points[2].z, sizeof(c));
    const Lanes yz = __builtin_shufflevector(a, b, 1, 2, 4, 5);
    const Lanes xy = __builtin_shufflevector(b, c, 2, 3, 5, 6);
    at[0] = __builtin_shufflevector(a, xy, 0, 3, 4, 6);
    at[1] = __builtin_shufflevector(yz, xy, 0, 2, 5, 7);
    at[2] = __builtin_shufflevector(yz, c, 1, 3, 4, 7);
  }
};

Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
Lanes smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
float largest(const Lanes& v) { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
float smallest(const Lanes& v) { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }

/// A block of at most kBlock points in fours; the last point fills unused lanes.
struct Block {
  FourPoints fours[kBlock / 4];
  std::size_t count;

  Block(const glm::vec3* points, std::size_t of) : count((of + 3) / 4) {
    for (std::size_t i = 0; i < of / 4; ++i) fours[i] = FourPoints(points + 4 * i);
    if (of % 4 == 0) return;
    glm::vec3 rest[4];
    for (std::size_t k = 0; k < 4; ++k) rest[k] = points[std::min(of / 4 * 4 + k, of - 1)];
    fours[of / 4] = FourPoints(rest);
  }

  PointBox box() const {
    PointBox out;
    for (int axis = 0; axis < 3; ++axis) {
      Lanes least = fours[0].at[axis], most = least;
      for (std::size_t i = 1; i < count; ++i) {
        least = smaller(least, fours[i].at[axis]);
        most = larger(most, fours[i].at[axis]);
      }
      out.low[axis] = smallest(least);
      out.high[axis] = largest(most);
    }
    return out;
  }
  float farthest(const glm::vec3& direction) const {
    Lanes most = Lanes{} - std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
      const Lanes(&p)[3] = fours[i].at;
      most = larger(most, p[0] * direction.x + p[1] * direction.y + p[2] * direction.z);
    }
    return largest(most);
  }
  float farthest2(const glm::vec3& from) const {
    Lanes most{};
    for (std::size_t i = 0; i < count; ++i) {
      const Lanes(&p)[3] = fours[i].at;
      const Lanes d[3] = {p[0] - from.x, p[1] - from.y, p[2] - from.z};
      most = larger(most, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    return largest(most);
  }
};

std::array<glm::dvec3, PosedExtent::kDirections> hull_directions() {
  std::array<glm::dvec3, PosedExtent::kDirections> out;
  std::size_t at = 0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) out[at++] = glm::normalize(glm::dvec3(x, y, z));
      }
    }
  }
  return out;
}

}  // namespace

void PointBox::add(const std::vector<glm::vec3>& points) {
  for (const glm::vec3& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
}

PosedExtent::PosedExtent(const glm::vec3& center)
    : center_(center), directions_(hull_directions()) {
  support_.fill(-std::numeric_limits<double>::infinity());
}

void PosedExtent::add(const std::vector<glm::vec3>& points) {
  for (std::size_t i = 0; i < points.size(); i += kBlock) {
    add_block(&points[i], std::min(kBlock, points.size() - i));
  }
}

void PosedExtent::add_block(const glm::vec3* points, std::size_t count) {
  const Block block(points, count);
  const PointBox box = block.box();
  box_.low = glm::min(box_.low, box.low);
  box_.high = glm::max(box_.high, box.high);
  const glm::dvec3 low(box.low), high(box.high), middle(center_);
  const glm::dvec3 reach = glm::max(glm::abs(low), glm::abs(high)) + glm::abs(middle);
  const double rounding = kRounding * (reach.x + reach.y + reach.z);
  // The negated comparison also catches numbers beyond the range of float.
  if (!(std::sqrt(double{block.farthest2(center_)}) + rounding <= std::sqrt(radius2_))) {
    for (const glm::vec3* p = points; p != points + count; ++p) {
      const glm::dvec3 off = glm::dvec3(*p) - middle;
      radius2_ = std::max(radius2_, glm::dot(off, off));
    }
  }
  for (std::size_t i = 0; i < kDirections; ++i) {
    const glm::dvec3& n = directions_[i];
    const glm::dvec3 corner(n.x > 0 ? high.x : low.x, n.y > 0 ? high.y : low.y,
                            n.z > 0 ? high.z : low.z);
    if (glm::dot(n, corner) <= support_[i]) continue;
    if (block.farthest(glm::vec3(n)) + rounding <= support_[i]) continue;
    for (const glm::vec3* p = points; p != points + count; ++p) {
      const double d = glm::dot(n, glm::dvec3(*p));
      if (d <= support_[i]) continue;
      support_[i] = d;
      points_[i] = *p;
    }
  }
}

double largest_step(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  float most = 0;
  for (std::size_t i = 0; i < a.size(); i += kBlock) {
    const std::size_t count = std::min(kBlock, a.size() - i);
    const Block from(&a[i], count), to(&b[i], count);
    Lanes block{};
    for (std::size_t k = 0; k < from.count; ++k) {
      Lanes d[3];
      for (std::size_t c = 0; c < 3; ++c) d[c] = to.fours[k].at[c] - from.fours[k].at[c];
      block = larger(block, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    most = std::max(most, largest(block));
  }
  return std::sqrt(double{most});
}

}  // namespace mirage

#include "server/scene/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mirage {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr std::uint32_t kSharedTriangles = 20'000;  // fewer are not worth another thread
constexpr std::size_t kDeepest = 64;  // halved until 4 are left: 30 for all of 32 bits

// A child that is a leaf: this bit, one less than its triangles in the next two, then the first.
constexpr std::uint32_t kLeaf = 1u << 31;
std::uint32_t leaf_of(std::uint32_t first, std::uint32_t count) {
  return kLeaf | (count - 1) << 29 | first;
}

// Inner nodes of a tree over so many triangles. Level by level: halving leaves `a` parts of `size`
// triangles and `b` of one more.
std::uint32_t inner_nodes(std::uint32_t triangles) {
  std::uint32_t size = triangles, a = 1, b = 0, count = 0;
  while (size > kLeafTriangles) {
    count += a + b;
    (size % 2 == 0 ? a : b) += a + b;
    size /= 2;
  }
  return size == kLeafTriangles ? count + b : count;
}

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

SurfaceTree::SurfaceTree(const std::vector<Vertex>& vertices,
                         const std::vector<std::uint32_t>& indices, const Workers& workers)
    : vertices_(vertices), indices_(indices), order_(indices.size() / 3), corners_(order_.size()) {
  if (order_.empty()) return;
  std::vector<Center> centers;
  centers.reserve(order_.size());
  for (std::uint32_t t = 0; t < order_.size(); ++t) {
    const std::uint32_t* at = &indices[3 * std::size_t{t}];
    centers.push_back(
        {(vertices[at[0]].position + vertices[at[1]].position + vertices[at[2]].position) / 3.0f,
         t});
  }
  const auto count = static_cast<std::uint32_t>(order_.size());
  nodes_.resize(inner_nodes(count));
  if (nodes_.empty()) {
    root_ = leaf_of(0, count);
    make_leaf(0, count, centers);
  } else {
    build(0, 0, count, centers, workers);
  }
}

SurfaceTree::Box SurfaceTree::make_leaf(std::uint32_t first, std::uint32_t count,
                                        const std::vector<Center>& centers) {
  Box box{glm::vec3(std::numeric_limits<float>::infinity()),
          glm::vec3(-std::numeric_limits<float>::infinity())};
  for (std::uint32_t i = first; i < first + count; ++i) {
    order_[i] = centers[i].triangle;
    const std::uint32_t* t = &indices_[3 * std::size_t{order_[i]}];
    corners_[i] = {vertices_[t[0]].position, vertices_[t[1]].position, vertices_[t[2]].position};
    for (const glm::vec3& p : {corners_[i].a, corners_[i].b, corners_[i].c}) {
      box.low = glm::min(box.low, p);
      box.high = glm::max(box.high, p);
    }
  }
  return box;
}

SurfaceTree::Box SurfaceTree::build(std::uint32_t at, std::uint32_t first, std::uint32_t count,
                                    std::vector<Center>& centers, const Workers& workers) {
  const auto begin = centers.begin() + first;
  glm::vec3 low = begin->at, high = begin->at;
  for (auto center = begin; center != begin + count; ++center) {
    low = glm::min(low, center->at);
    high = glm::max(high, center->at);
  }
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count,
                   [axis](const Center& a, const Center& b) { return a.at[axis] < b.at[axis]; });
  const std::uint32_t firsts[2] = {first, first + half}, counts[2] = {half, count - half},
                      places[2] = {at + 1, at + 1 + inner_nodes(half)};
  Node& node = nodes_[at];
  const auto child = [&](std::size_t i) {
    const bool leaf = counts[i] <= kLeafTriangles;
    node.child[i] = leaf ? leaf_of(firsts[i], counts[i]) : places[i];
    const Box box = leaf ? make_leaf(firsts[i], counts[i], centers)
                         : build(places[i], firsts[i], counts[i], centers, workers);
    for (int c = 0; c < 3; ++c) {
      node.low[c][i] = box.low[c];
      node.high[c][i] = box.high[c];
    }
  };
  if (count > kSharedTriangles) {
    workers.each(2, child);
  } else {
    child(0);
    child(1);
  }
  Box box;
  for (int c = 0; c < 3; ++c) {
    box.low[c] = std::min(node.low[c][0], node.low[c][1]);
    box.high[c] = std::max(node.high[c][0], node.high[c][1]);
  }
  return box;
}

inline void SurfaceTree::try_triangle(std::uint32_t place, const glm::vec3& p,
                                      Nearest& best) const {
  const Corners& t = corners_[place];
  const glm::vec3 point = closest_on_triangle(p, t.a, t.b, t.c);
  const float distance2 = glm::dot(point - p, point - p);
  if (distance2 < best.distance2) best = {distance2, place, point};
}

void SurfaceTree::search(const glm::vec3& p, float enough2, Nearest& best) const {
  struct Waiting {
    std::uint32_t child;
    float distance2;
  };
  Waiting stack[kDeepest];
  std::size_t waiting = 0;
  stack[waiting++] = {root_, 0};
  while (waiting > 0 && best.distance2 > enough2) {
    auto [at, distance2] = stack[--waiting];
    while (distance2 < best.distance2 &&
           !(at & kLeaf)) {  // to the nearer leaf, the other sides wait
      const Node& node = nodes_[at];
      float outside2[2] = {0, 0};
      for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < 2; ++i) {
          const float d = std::max(std::max(node.low[c][i] - p[c], p[c] - node.high[c][i]), 0.0f);
          outside2[i] += d * d;
        }
      }
      const int near = outside2[1] < outside2[0] ? 1 : 0;
      if (outside2[1 - near] < best.distance2) {
        stack[waiting++] = {node.child[1 - near], outside2[1 - near]};
      }
      at = node.child[near];
      distance2 = outside2[near];
    }
    if (distance2 >= best.distance2) continue;
    const std::uint32_t first = at & ((1u << 29) - 1), count = (at >> 29 & 3) + 1;
    for (std::uint32_t i = first; i < first + count; ++i) try_triangle(i, p, best);
  }
}

double SurfaceTree::distance(const glm::vec3& p, double at_most) const {
  Nearest best{static_cast<float>(at_most * at_most), 0, p};
  if (!order_.empty()) search(p, 0, best);
  return std::sqrt(double{best.distance2});
}

double SurfaceTree::distance_above(double floor, const glm::vec3& p, double at_most,
                                   std::uint32_t& near) const {
  Nearest best{static_cast<float>(at_most * at_most), near, p};
  if (!order_.empty()) {
    try_triangle(near, p, best);
    search(p, static_cast<float>(floor * floor), best);
  }
  near = best.place;
  return std::sqrt(double{best.distance2});
}

SurfaceTree::Shading SurfaceTree::shading_at(const glm::vec3& p) const {
  std::uint32_t near = 0;
  return shading_at(p, near);
}

SurfaceTree::Shading SurfaceTree::shading_at(const glm::vec3& p, std::uint32_t& near) const {
  Shading out;
  if (order_.empty()) return out;
  Nearest best{std::numeric_limits<float>::infinity(), near, p};
  try_triangle(near, p, best);
  search(p, 0, best);
  near = best.place;
  const std::uint32_t* t = &indices_[3 * std::size_t{order_[best.place]}];
  const auto& [a, b, c] = corners_[best.place];
  // Shares of the triangle's area opposite to each corner.
  const glm::vec3 areas(glm::length(glm::cross(b - best.point, c - best.point)),
                        glm::length(glm::cross(c - best.point, a - best.point)),
                        glm::length(glm::cross(a - best.point, b - best.point)));
  const float area = areas.x + areas.y + areas.z;
  for (int k = 0; k < 3; ++k) {
    const float share = area > 0 ? areas[k] / area : 1.0f / 3.0f;
    out.normal += share * vertices_[t[k]].normal;
    out.color += share * glm::vec4(vertices_[t[k]].color) / 65535.0f;
  }
  const float length = glm::length(out.normal);
  if (length > 0) out.normal /= length;
  return out;
}

std::vector<std::uint32_t> SurfaceTree::places_of_vertices() const {
  std::vector<std::uint32_t> out(vertices_.size(), 0);
  for (std::uint32_t place = 0; place < order_.size(); ++place) {
    for (std::size_t k = 0; k < 3; ++k) out[indices_[3 * std::size_t{order_[place]} + k]] = place;
  }
  return out;
}

}  // namespace mirage

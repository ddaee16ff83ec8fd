#include "server/scene/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace mirage {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;

float box_distance2(const glm::vec3& low, const glm::vec3& high, const glm::vec3& p) {
  const glm::vec3 d = glm::max(glm::max(low - p, p - high), glm::vec3(0));
  return glm::dot(d, d);
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
                         const std::vector<std::uint32_t>& indices)
    : vertices_(vertices), indices_(indices), order_(indices.size() / 3) {
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<glm::vec3> centers;
  centers.reserve(order_.size());
  for (std::size_t t = 0; t < order_.size(); ++t) {
    centers.push_back((vertices[indices[3 * t]].position + vertices[indices[3 * t + 1]].position +
                       vertices[indices[3 * t + 2]].position) /
                      3.0f);
  }
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()), centers);
}

void SurfaceTree::build(std::uint32_t first, std::uint32_t count, std::vector<glm::vec3>& centers) {
  const std::size_t at = nodes_.size();
  nodes_.emplace_back();
  Node node;
  node.low = glm::vec3(std::numeric_limits<float>::infinity());
  node.high = -node.low;
  glm::vec3 low = node.low, high = node.high;  // of the centres
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const glm::vec3& p = vertices_[indices_[3 * std::size_t{order_[i]} + k]].position;
      node.low = glm::min(node.low, p);
      node.high = glm::max(node.high, p);
    }
    low = glm::min(low, centers[order_[i]]);
    high = glm::max(high, centers[order_[i]]);
  }
  if (count <= kLeafTriangles) {
    node.first = first;
    node.count = count;
    nodes_[at] = node;
    return;
  }
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    return centers[a][axis] < centers[b][axis];
  });
  build(first, half, centers);
  node.first = static_cast<std::uint32_t>(nodes_.size());
  build(first + half, count - half, centers);
  nodes_[at] = node;
}

void SurfaceTree::search(std::uint32_t index, const glm::vec3& p, Nearest& best) const {
  const Node& node = nodes_[index];
  if (node.count > 0) {
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const std::uint32_t* t = &indices_[3 * std::size_t{order_[i]}];
      const glm::vec3 point = closest_on_triangle(
          p, vertices_[t[0]].position, vertices_[t[1]].position, vertices_[t[2]].position);
      const float distance2 = glm::dot(point - p, point - p);
      if (distance2 < best.distance2) best = {distance2, order_[i], point};
    }
    return;
  }
  std::uint32_t near = index + 1, far = node.first;
  float near2 = box_distance2(nodes_[near].low, nodes_[near].high, p);
  float far2 = box_distance2(nodes_[far].low, nodes_[far].high, p);
  if (far2 < near2) {
    std::swap(near, far);
    std::swap(near2, far2);
  }
  if (near2 < best.distance2) search(near, p, best);
  if (far2 < best.distance2) search(far, p, best);
}

double SurfaceTree::distance(const glm::vec3& p, double at_most) const {
  Nearest best{static_cast<float>(at_most * at_most), 0, p};
  if (!nodes_.empty()) search(0, p, best);
  return std::sqrt(double{best.distance2});
}

SurfaceTree::Shading SurfaceTree::shading_at(const glm::vec3& p) const {
  Shading out;
  if (nodes_.empty()) return out;
  Nearest best{std::numeric_limits<float>::infinity(), 0, p};
  search(0, p, best);
  const std::uint32_t* t = &indices_[3 * std::size_t{best.triangle}];
  const glm::vec3 a = vertices_[t[0]].position, b = vertices_[t[1]].position,
                  c = vertices_[t[2]].position;
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

}  // namespace mirage

#include "server/lod/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mirage {
namespace {

// a leaf always has this many places, used or not
constexpr std::uint32_t kLeafTriangles = 4;
constexpr std::uint32_t kSharedTriangles = 20'000;  // fewer are not worth another thread
constexpr std::size_t kDeepest = 64;  // halving down to 4 takes 30 steps for 32-bit counts

constexpr std::uint32_t kLeaf = 1u << 31;  // a child with this bit is a leaf, else an inner node

// Returns the number of inner nodes of a tree over so many triangles. On each level, halving leaves
// `a` parts of `size` triangles and `b` parts of one more.
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

SurfaceTree::SurfaceTree(const std::vector<Vertex>& vertices,
                         const std::vector<std::uint32_t>& indices, const Workers& workers)
    : vertices_(vertices), indices_(indices) {
  const auto count = static_cast<std::uint32_t>(indices.size() / 3);
  if (count == 0) return;
  std::vector<Center> centers;
  centers.reserve(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::uint32_t* at = &indices[3 * std::size_t{t}];
    centers.push_back(
        {(vertices[at[0]].position + vertices[at[1]].position + vertices[at[2]].position) / 3.0f,
         t});
  }
  nodes_.resize(inner_nodes(count));
  leaves_.resize(nodes_.size() + 1);
  order_.resize(leaves_.size() * kLeafTriangles);
  if (nodes_.empty()) {
    root_ = kLeaf;
    make_leaf(0, &centers[0], count);
  } else {
    build(0, 0, &centers[0], count, workers);
  }
}

SurfaceTree::Box SurfaceTree::make_leaf(std::uint32_t leaf, const Center* centers,
                                        std::uint32_t count) {
  Box box{glm::vec3(std::numeric_limits<float>::infinity()),
          glm::vec3(-std::numeric_limits<float>::infinity())};
  for (std::uint32_t lane = 0; lane < kLeafTriangles; ++lane) {
    // Unused lanes repeat the first triangle and are never nearer than it.
    const std::uint32_t triangle = centers[lane < count ? lane : 0].triangle;
    order_[leaf * kLeafTriangles + lane] = triangle;
    const std::uint32_t* t = &indices_[3 * std::size_t{triangle}];
    const glm::vec3 corners[3] = {vertices_[t[0]].position, vertices_[t[1]].position,
                                  vertices_[t[2]].position};
    leaves_[leaf].set(lane, corners[0], corners[1], corners[2]);
    for (const glm::vec3& p : corners) {
      box.low = glm::min(box.low, p);
      box.high = glm::max(box.high, p);
    }
  }
  return box;
}

SurfaceTree::Box SurfaceTree::build(std::uint32_t at, std::uint32_t leaf, Center* centers,
                                    std::uint32_t count, const Workers& workers) {
  glm::vec3 low = centers->at, high = centers->at;
  for (const Center* center = centers; center != centers + count; ++center) {
    low = glm::min(low, center->at);
    high = glm::max(high, center->at);
  }
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  std::nth_element(centers, centers + half, centers + count,
                   [axis](const Center& a, const Center& b) { return a.at[axis] < b.at[axis]; });
  const std::uint32_t inner = inner_nodes(half);  // the leaves are one more
  const std::uint32_t counts[2] = {half, count - half}, nodes[2] = {at + 1, at + 1 + inner},
                      leaves[2] = {leaf, leaf + inner + 1};
  Node& node = nodes_[at];
  const auto child = [&](std::size_t i) {
    const bool is_leaf = counts[i] <= kLeafTriangles;
    node.child[i] = is_leaf ? kLeaf | leaves[i] : nodes[i];
    Center* const own = centers + (i == 0 ? 0 : half);
    const Box box = is_leaf ? make_leaf(leaves[i], own, counts[i])
                            : build(nodes[i], leaves[i], own, counts[i], workers);
    for (int c = 0; c < 3; ++c) {
      node.bounds[c][i] = box.low[c];
      node.bounds[c][2 + i] = -box.high[c];
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
    box.low[c] = std::min(node.bounds[c][0], node.bounds[c][1]);
    box.high[c] = -std::min(node.bounds[c][2], node.bounds[c][3]);
  }
  return box;
}

glm::vec3 SurfaceTree::corner(std::uint32_t place, std::size_t number) const {
  return leaves_[place / kLeafTriangles].corner(place % kLeafTriangles, number);
}

void SurfaceTree::try_triangle(std::uint32_t place, const glm::vec3& p, Nearest& best) const {
  const glm::vec3 point =
      closest_on_triangle(p, corner(place, 0), corner(place, 1), corner(place, 2));
  const float distance2 = glm::dot(point - p, point - p);
  if (distance2 < best.distance2) best = {distance2, place, point};
}

void SurfaceTree::try_leaf(std::uint32_t leaf, const glm::vec3& p, Nearest& best) const {
  const FourTriangles::Nearest found = leaves_[leaf].nearest(p);
  for (std::uint32_t lane = 0; lane < kLeafTriangles; ++lane) {
    if (!(found.distance2[lane] < best.distance2)) continue;
    best = {found.distance2[lane],
            leaf * kLeafTriangles + lane,
            {found.point[0][lane], found.point[1][lane], found.point[2][lane]}};
  }
}

void SurfaceTree::search(const glm::vec3& p, float enough2, Nearest& best) const {
  const Lanes place[3] = {{p.x, p.x, -p.x, -p.x}, {p.y, p.y, -p.y, -p.y}, {p.z, p.z, -p.z, -p.z}};
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
           !(at & kLeaf)) {  // descends to the nearer leaf; the other children wait
      const Node& node = nodes_[at];
      Lanes outside2{};  // by child
      for (int c = 0; c < 3; ++c) {
        const Lanes beyond = node.bounds[c] - place[c];
        const Lanes other = __builtin_shufflevector(beyond, beyond, 2, 3, 0, 1);
        Lanes d = beyond > other ? beyond : other;
        d = d > 0 ? d : Lanes{};
        outside2 += d * d;
      }
      const int near = outside2[1] < outside2[0] ? 1 : 0;
      if (outside2[1 - near] < best.distance2) {
        stack[waiting++] = {node.child[1 - near], outside2[1 - near]};
      }
      at = node.child[near];
      distance2 = outside2[near];
    }
    if (distance2 >= best.distance2) continue;
    try_leaf(at & ~kLeaf, p, best);
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
    try_leaf(near / kLeafTriangles, p, best);
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
  const glm::vec3 a = corner(best.place, 0), b = corner(best.place, 1), c = corner(best.place, 2);
  // Areas opposite to each corner give the corners' weights.
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
    const std::uint32_t lane = place % kLeafTriangles;
    // skips repeats of the first triangle
    if (lane > 0 && order_[place] == order_[place - lane]) continue;
    for (std::size_t k = 0; k < 3; ++k) out[indices_[3 * std::size_t{order_[place]} + k]] = place;
  }
  return out;
}

}  // namespace mirage

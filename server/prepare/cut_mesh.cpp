#include "server/prepare/cut_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <unordered_map>

namespace mirage {
namespace {

constexpr float kPartShare = 0.125f;     // radius of a part relative to the mesh's
constexpr float kEdgeShare = 0.25f;      // longest edge relative to a part's radius
constexpr std::size_t kMostDivided = 4;  // most triangles after dividing, relative to those before
constexpr std::size_t kFewElements = 8;  // not worth cutting

struct Box {
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};
  void add(const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  float radius() const { return 0.5f * glm::length(high - low); }
};

std::uint32_t corners(PrimitiveKind kind) {
  return kind == PrimitiveKind::kTriangles ? 3 : kind == PrimitiveKind::kLines ? 2 : 1;
}

Box box_of(const Mesh& mesh) {
  Box out;
  for (const std::uint32_t i : mesh.indices) out.add(mesh.vertices[i].position);
  return out;
}

// Attributes are interpolated linearly along an edge, normals included, as the rasteriser does.
Vertex middle(const Vertex& a, const Vertex& b) {
  Vertex out;
  out.position = 0.5f * (a.position + b.position);
  out.normal = 0.5f * (a.normal + b.normal);
  out.tangent = glm::vec4(0.5f * (glm::vec3(a.tangent) + glm::vec3(b.tangent)), a.tangent.w);
  out.uv0 = 0.5f * (a.uv0 + b.uv0);
  out.uv1 = 0.5f * (a.uv1 + b.uv1);
  for (int c = 0; c < 4; ++c) {
    out.color[c] = static_cast<std::uint16_t>((std::uint32_t{a.color[c]} + b.color[c]) / 2);
  }
  return out;
}

// Divides triangles until no edge is longer than `longest`.
class Divider {
 public:
  Divider(const Mesh& mesh, float longest) : longest_(longest) {
    out_.vertices = mesh.vertices;
    most_ = kMostDivided * mesh.indices.size() + 3 * kMostParts * kMostParts;
    for (const Primitive& p : mesh.primitives) {
      Primitive divided = p;
      divided.first_index = static_cast<std::uint32_t>(out_.indices.size());
      const std::uint32_t* at = mesh.indices.data() + p.first_index;
      for (std::uint32_t i = 0; i < p.index_count; i += corners(p.kind)) {
        if (p.kind == PrimitiveKind::kTriangles) {
          divide({at[i], at[i + 1], at[i + 2]});
        } else {
          out_.indices.insert(out_.indices.end(), at + i, at + i + corners(p.kind));
        }
      }
      divided.index_count = static_cast<std::uint32_t>(out_.indices.size()) - divided.first_index;
      out_.primitives.push_back(divided);
    }
  }
  Mesh take() { return std::move(out_); }

 private:
  // Divides at the middle of the longest edge. In the end every edge that is too long is divided at
  // its middle, whichever of its triangles came first.
  void divide(std::array<std::uint32_t, 3> t) {
    std::vector<std::array<std::uint32_t, 3>> left{t};
    while (!left.empty()) {
      t = left.back();
      left.pop_back();
      int longest = 0;
      float length = -1;
      for (int k = 0; k < 3; ++k) {
        const float l = glm::distance(place(t[k]), place(t[(k + 1) % 3]));
        if (l > length) {
          length = l;
          longest = k;
        }
      }
      if (!(length > longest_) || out_.indices.size() + 3 * left.size() >= most_) {
        out_.indices.insert(out_.indices.end(), t.begin(), t.end());
        continue;
      }
      const std::uint32_t a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3];
      const std::uint32_t m = middle_of(a, b);
      left.push_back({m, b, c});
      left.push_back({a, m, c});
    }
  }
  const glm::vec3& place(std::uint32_t v) const { return out_.vertices[v].position; }
  std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
    const auto [at, is_new] =
        middles_.emplace(key, static_cast<std::uint32_t>(out_.vertices.size()));
    if (is_new) {
      out_.vertices.push_back(middle(out_.vertices[std::min(a, b)], out_.vertices[std::max(a, b)]));
    }
    return at->second;
  }

  float longest_;
  std::size_t most_;
  Mesh out_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;
};

// A triangle, line or point.
struct Element {
  std::uint32_t primitive, first;  // into the mesh's indices
  Box box;
  float middle(int axis) const { return 0.5f * (box.low[axis] + box.high[axis]); }
};

std::vector<Element> elements_of(const Mesh& mesh) {
  std::vector<Element> out;
  for (std::uint32_t p = 0; p < mesh.primitives.size(); ++p) {
    const Primitive& primitive = mesh.primitives[p];
    const std::uint32_t n = corners(primitive.kind);
    for (std::uint32_t i = 0; i + n <= primitive.index_count; i += n) {
      Element e{p, primitive.first_index + i, {}};
      for (std::uint32_t k = 0; k < n; ++k) {
        e.box.add(mesh.vertices[mesh.indices[e.first + k]].position);
      }
      out.push_back(e);
    }
  }
  return out;
}

// A range of elements.
struct Run {
  float radius;
  std::size_t first, last;
  bool operator<(const Run& other) const {
    return radius != other.radius ? radius < other.radius : first > other.first;
  }
};

class Cutter {
 public:
  Cutter(const Mesh& mesh, float part_radius) : mesh_(mesh), elements_(elements_of(mesh)) {
    weld();
    std::priority_queue<Run> open;
    open.push(measured(0, elements_.size()));
    while (open.size() + runs_.size() < kMostParts && !open.empty()) {
      const Run run = open.top();
      open.pop();
      if (run.radius <= part_radius || run.last - run.first < 2 * kFewElements) {
        runs_.push_back(run);
        continue;
      }
      const std::size_t middle = halve(run);
      open.push(measured(run.first, middle));
      open.push(measured(middle, run.last));
    }
    for (; !open.empty(); open.pop()) runs_.push_back(open.top());
    std::sort(runs_.begin(), runs_.end(),
              [](const Run& a, const Run& b) { return a.first < b.first; });
  }

  std::vector<Mesh> parts(const Workers& workers) {
    std::vector<Mesh> out;
    if (runs_.size() < 2) return out;
    // Lists the elements at each place.
    std::vector<std::uint32_t> first(places_ + 1, 0), at_place;
    each_corner([&](std::size_t, std::uint32_t place) { ++first[place + 1]; });
    std::partial_sum(first.begin(), first.end(), first.begin());
    at_place.resize(first.back());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    each_corner([&](std::size_t e, std::uint32_t place) {
      at_place[next[place]++] = static_cast<std::uint32_t>(e);
    });
    out.resize(runs_.size());
    workers.each(runs_.size(), [&](std::size_t r) {
      std::vector<std::uint32_t> members;
      std::vector<bool> taken(elements_.size(), false);
      for (std::size_t e = runs_[r].first; e < runs_[r].last; ++e) {
        const std::uint32_t n = corners(mesh_.primitives[elements_[e].primitive].kind);
        for (std::uint32_t k = 0; k < n; ++k) {
          const std::uint32_t place = place_[mesh_.indices[elements_[e].first + k]];
          for (std::uint32_t i = first[place]; i < first[place + 1]; ++i) {
            if (taken[at_place[i]]) continue;
            taken[at_place[i]] = true;
            members.push_back(at_place[i]);
          }
        }
      }
      out[r] = extract(members);
    });
    return out;
  }

 private:
  // Vertices at the same position are neighbours, whatever else they differ in.
  void weld() {
    std::vector<std::pair<std::array<float, 3>, std::uint32_t>> order(mesh_.vertices.size());
    for (std::uint32_t v = 0; v < order.size(); ++v) {
      const glm::vec3& p = mesh_.vertices[v].position;
      order[v] = {{p.x, p.y, p.z}, v};
    }
    std::sort(order.begin(), order.end());
    place_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i > 0 && order[i].first != order[i - 1].first) ++places_;
      place_[order[i].second] = places_;
    }
    ++places_;
  }
  template <typename Visit>
  void each_corner(const Visit& visit) const {
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const std::uint32_t n = corners(mesh_.primitives[elements_[e].primitive].kind);
      for (std::uint32_t k = 0; k < n; ++k) visit(e, place_[mesh_.indices[elements_[e].first + k]]);
    }
  }
  Run measured(std::size_t first, std::size_t last) const {
    Box box;
    for (std::size_t e = first; e < last; ++e) {
      box.low = glm::min(box.low, elements_[e].box.low);
      box.high = glm::max(box.high, elements_[e].box.high);
    }
    return {box.radius(), first, last};
  }
  std::size_t halve(const Run& run) {
    glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
    for (std::size_t e = run.first; e < run.last; ++e) {
      const glm::vec3 middle = 0.5f * (elements_[e].box.low + elements_[e].box.high);
      low = glm::min(low, middle);
      high = glm::max(high, middle);
    }
    const glm::vec3 side = high - low;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const float half = 0.5f * (low[axis] + high[axis]);
    const auto at = [&](std::size_t k) {
      return elements_.begin() + static_cast<std::ptrdiff_t>(k);
    };
    const auto middle = std::partition(at(run.first), at(run.last),
                                       [&](const Element& e) { return e.middle(axis) < half; });
    const auto found = static_cast<std::size_t>(middle - elements_.begin());
    // All elements are at one place: split by number.
    return found > run.first && found < run.last ? found : (run.first + run.last) / 2;
  }
  // Members are sorted in the mesh's order, so that coincident surfaces keep their order.
  Mesh extract(std::vector<std::uint32_t>& members) const {
    std::sort(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
      return elements_[a].first < elements_[b].first;
    });
    Mesh out;
    std::uint32_t open = std::numeric_limits<std::uint32_t>::max();
    for (const std::uint32_t m : members) {
      const Element& e = elements_[m];
      const Primitive& of = mesh_.primitives[e.primitive];
      if (e.primitive != open) {
        out.primitives.push_back(
            {of.kind, static_cast<std::uint32_t>(out.indices.size()), 0, of.material});
        open = e.primitive;
      }
      const auto first = mesh_.indices.begin() + e.first;
      out.indices.insert(out.indices.end(), first, first + corners(of.kind));
      out.primitives.back().index_count += corners(of.kind);
    }
    std::vector<std::uint32_t> used = out.indices;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (std::uint32_t& index : out.indices) {
      const auto at = std::lower_bound(used.begin(), used.end(), index);
      index = static_cast<std::uint32_t>(at - used.begin());
    }
    for (const std::uint32_t vertex : used) out.vertices.push_back(mesh_.vertices[vertex]);
    return out;
  }

  const Mesh& mesh_;
  std::vector<Element> elements_;
  std::vector<Run> runs_;
  std::vector<std::uint32_t> place_;  // by vertex
  std::uint32_t places_ = 0;
};

}  // namespace

std::vector<Mesh> cut_mesh(const Mesh& mesh, const Workers& workers) {
  if (mesh.indices.empty()) return {};
  const float part = kPartShare * box_of(mesh).radius();
  if (!(part > 0) || !std::isfinite(part)) return {};
  const Mesh divided = Divider(mesh, kEdgeShare * part).take();
  return Cutter(divided, part).parts(workers);
}

}  // namespace mirage

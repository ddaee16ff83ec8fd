#include "server/lod/seams.h"

#include <cmath>
#include <cstdint>

namespace mirage {
namespace {

constexpr double kSeamRounding = 1.0 / (1 << 22);  // of the largest coordinate
// edge in roundings: most searches look into one cell
constexpr double kCell = 8;
constexpr int kCellBits = 21;  // bits per axis: 2^22 / 8 cells on either side of 0

/// A set of distinct positions, found through the cells of a grid.
class Places {
 public:
  explicit Places(const std::vector<Vertex>& vertices) {
    glm::dvec3 largest(0);
    for (const Vertex& v : vertices) largest = glm::max(largest, glm::abs(glm::dvec3(v.position)));
    reach_ = kSeamRounding * largest;
    std::size_t buckets = 2;
    while (buckets < vertices.size()) buckets *= 2;
    youngest_.assign(buckets, kNone);
    places_.reserve(vertices.size());
  }

  /// Returns the place that `p` coincides with; if there is none, adds `p` as a new one.
  glm::vec3 place_of(const glm::vec3& p) {
    const glm::dvec3 at(p);
    const glm::i64vec3 low = cell(at - reach_), high = cell(at + reach_);
    for (std::int64_t z = low.z; z <= high.z; ++z) {
      for (std::int64_t y = low.y; y <= high.y; ++y) {
        for (std::int64_t x = low.x; x <= high.x; ++x) {
          const std::uint64_t here = key({x, y, z});
          for (std::uint32_t i = youngest_[bucket(here)]; i != kNone; i = places_[i].older) {
            const glm::dvec3 place(places_[i].position);
            if (one(place, at) && key(cell(place)) == here) return places_[i].position;
          }
        }
      }
    }
    std::uint32_t& youngest = youngest_[bucket(key(cell(at)))];
    places_.push_back({p, youngest});
    youngest = static_cast<std::uint32_t>(places_.size() - 1);
    return p;
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  struct Place {
    glm::vec3 position;
    std::uint32_t older;  ///< next older place in the same bucket
  };

  std::size_t bucket(std::uint64_t key) const {
    return (key * 0x9e3779b97f4a7c15ull >> 32) & (youngest_.size() - 1);
  }
  glm::i64vec3 cell(const glm::dvec3& p) const {
    glm::i64vec3 out(0);
    for (int i = 0; i < 3; ++i) {
      if (reach_[i] > 0) out[i] = static_cast<std::int64_t>(std::floor(p[i] / (kCell * reach_[i])));
    }
    return out;
  }
  static std::uint64_t key(const glm::i64vec3& cell) {
    std::uint64_t out = 0;
    for (int i = 0; i < 3; ++i) {
      out = (out << kCellBits) | static_cast<std::uint64_t>(cell[i] + (1 << (kCellBits - 1)));
    }
    return out;
  }
  bool one(const glm::dvec3& a, const glm::dvec3& b) const {
    return glm::all(glm::lessThanEqual(glm::abs(a - b), reach_));
  }

  glm::dvec3 reach_{0};
  std::vector<std::uint32_t> youngest_;  ///< by bucket of cells
  std::vector<Place> places_;
};

}  // namespace

std::vector<glm::vec3> closed_positions(const std::vector<Vertex>& vertices) {
  Places places(vertices);
  std::vector<glm::vec3> out;
  out.reserve(vertices.size());
  for (const Vertex& v : vertices) out.push_back(places.place_of(v.position));
  return out;
}

}  // namespace mirage

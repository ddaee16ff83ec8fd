#include "server/prepare/leave_out_covered.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <functional>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "server/scene/scene.h"

namespace mirage {
namespace {

// Two places are the same if they are this part of their object's extent apart: objects have
// places of 24 bits, and each transform rounds.
constexpr double kSame = 2e-6;
// To find pairs that share places, only a part of the places of larger meshes is looked at.
constexpr std::size_t kWholeMesh = 2048;
constexpr std::uint64_t kOneIn = 16;
// A pair is compared triangle by triangle if the smaller one shares this part of its places.
constexpr double kShared = 0.1;
constexpr std::size_t kMostAtOnePlace = 16;
// Places looked at for pairs: of all instances of one mesh, and in all. A crowd has no copies.
constexpr std::size_t kMostPlacesOfOne = 2'000'000, kMostPlaces = 16'000'000;
constexpr std::size_t kMostCompared = 20'000'000;  // compared in all
// Some of an object's instances get an object of their own only if this times the hidden triangles
// are at least all of the mesh.
constexpr std::size_t kWorthACopy = 4;

std::uint64_t mixed(std::uint64_t x) {
  x ^= x >> 33;
  x *= 0xff51afd7ed558ccdULL;
  x ^= x >> 33;
  x *= 0xc4ceb9fe1a85ec53ULL;
  return x ^ (x >> 33);
}

using Cell = std::array<std::int64_t, 3>;

std::uint64_t hash_of(const Cell& cell) {
  std::uint64_t hash = 0;
  for (const std::int64_t c : cell) hash = mixed(hash ^ static_cast<std::uint64_t>(c));
  return hash;
}

// Gives equal numbers to places that lie within `same` of one another.
class Places {
 public:
  explicit Places(double same) : same_(same), cell_(16 * same) {}

  std::uint32_t number(const glm::dvec3& p) {
    std::array<std::array<std::int64_t, 2>, 3> range{};  // cells that hold anything near, by axis
    Cell own{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = [&](double x) { return static_cast<std::int64_t>(std::floor(x / cell_)); };
      own[axis] = at(p[axis]);
      range[axis] = {at(p[axis] - same_), at(p[axis] + same_)};
    }
    for (std::int64_t x = range[0][0]; x <= range[0][1]; ++x) {
      for (std::int64_t y = range[1][0]; y <= range[1][1]; ++y) {
        for (std::int64_t z = range[2][0]; z <= range[2][1]; ++z) {
          const auto [first, last] = cells_.equal_range(hash_of({x, y, z}));
          for (auto it = first; it != last; ++it) {
            const glm::dvec3 apart = glm::abs(places_[it->second] - p);
            if (std::max({apart.x, apart.y, apart.z}) <= same_) return it->second;
          }
        }
      }
    }
    const auto next = static_cast<std::uint32_t>(places_.size());
    places_.push_back(p);
    cells_.emplace(hash_of(own), next);
    return next;
  }

 private:
  double same_, cell_;
  std::vector<glm::dvec3> places_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> cells_;
};

// A triangle of an instance, with its corners' places in order of number.
struct Laid {
  std::array<std::uint32_t, 3> corners{};
  std::uint32_t instance = 0;
  std::uint32_t triangle = 0;  // of the mesh: first index / 3
  bool turned = false;         // the other way round than its corners in order
  bool covers = false;         // opaque
  bool two_sided = false;

  // In the order in which they are drawn, those on the same corners together.
  bool operator<(const Laid& other) const {
    return std::tie(corners, instance, triangle) <
           std::tie(other.corners, other.instance, other.triangle);
  }
};

// Sides of a triangle that nobody sees; as bits.
constexpr std::uint8_t kFront = 1, kBack = 2, kBoth = 3;
struct Hidden {
  std::uint32_t triangle = 0;  // of the mesh: first index / 3
  std::uint8_t sides = 0;

  auto operator<=>(const Hidden&) const = default;
};

// Returns the vertex as a triangle turned round needs it: its front is shaded as its back was.
Vertex turned_round(Vertex v) {
  v.normal = -v.normal;
  v.tangent = -v.tangent;
  return v;
}

// Makes the form of a mesh without what is hidden. Triangles of which one side is hidden become
// single-sided.
class MeshCut {
 public:
  // `single_sided` returns the single-sided form of a material.
  MeshCut(const Mesh& mesh, std::function<std::uint32_t(std::uint32_t)> single_sided)
      : mesh_(mesh), single_sided_(std::move(single_sided)) {}

  Mesh without(const std::vector<Hidden>& hidden) {
    std::vector<std::uint8_t> sides(mesh_.indices.size() / 3, 0);
    for (const Hidden& one : hidden) sides[one.triangle] = one.sides;
    for (const Primitive& p : mesh_.primitives) {
      if (p.kind != PrimitiveKind::kTriangles) {
        add(p, p.material, 1, [](std::uint32_t) { return true; });
        continue;
      }
      const auto with = [&](std::uint8_t wanted) {
        return [&, wanted](std::uint32_t k) { return sides[k / 3] == wanted; };
      };
      add(p, p.material, 3, with(0));
      const bool cut = std::any_of(sides.begin(), sides.end(), [](std::uint8_t side) {
        return side == kFront || side == kBack;
      });
      if (!cut) continue;
      const std::uint32_t material = single_sided_(p.material);
      add(p, material, 3, with(kBack));
      turn_ = true;
      add(p, material, 3, with(kFront));
      turn_ = false;
    }
    return std::move(out_);
  }

 private:
  // Adds the runs of `step` indices of a primitive whose first index `wanted` takes.
  void add(const Primitive& p, std::uint32_t material, std::uint32_t step,
           const std::function<bool(std::uint32_t)>& wanted) {
    Primitive kept = p;
    kept.material = material;
    kept.first_index = static_cast<std::uint32_t>(out_.indices.size());
    for (std::uint32_t k = p.first_index; k + step <= p.first_index + p.index_count; k += step) {
      if (!wanted(k)) continue;
      for (std::uint32_t i = 0; i < step; ++i) {
        out_.indices.push_back(vertex(mesh_.indices[k + (turn_ ? step - 1 - i : i)]));
      }
    }
    kept.index_count = static_cast<std::uint32_t>(out_.indices.size()) - kept.first_index;
    if (kept.index_count > 0) out_.primitives.push_back(kept);
  }

  std::uint32_t vertex(std::uint32_t from) {
    const auto next = static_cast<std::uint32_t>(out_.vertices.size());
    const auto [at, is_new] = place_.try_emplace(std::pair{from, turn_}, next);
    if (is_new) {
      const Vertex& v = mesh_.vertices[from];
      out_.vertices.push_back(turn_ ? turned_round(v) : v);
    }
    return at->second;
  }

  const Mesh& mesh_;
  std::function<std::uint32_t(std::uint32_t)> single_sided_;
  Mesh out_;
  std::map<std::pair<std::uint32_t, bool>, std::uint32_t> place_;
  bool turn_ = false;
};

// Returns the extent of each object, object units: the largest coordinate.
std::vector<double> extents_of(const Scene& scene) {
  std::vector<double> out;
  for (const SceneObject& object : scene.objects) {
    float extent = 0;
    for (const Vertex& v : object.mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) extent = std::max(extent, std::abs(v.position[axis]));
    }
    out.push_back(double{extent});
  }
  return out;
}

glm::dvec3 placed(const Instance& one, const Vertex& v) {
  const Similarity& s = one.world_from_object;
  return s.position + glm::dquat(s.rotation) * (double{s.scale} * glm::dvec3(v.position));
}

// True if an object has triangles and does not move.
bool takes_part(const SceneObject& object) {
  const std::vector<Primitive>& all = object.mesh.primitives;
  return !object.animation && !object.track.moves() &&
         std::any_of(all.begin(), all.end(), [](const Primitive& p) {
           return p.kind == PrimitiveKind::kTriangles && p.index_count > 0;
         });
}

// Returns the cells of an instance's places, each once; of a large mesh, a part of them. The part
// depends on the places alone, so that it is the same part of a copy.
std::vector<std::uint64_t> cells_of(const Instance& one, const std::vector<Vertex>& vertices,
                                    double cell) {
  std::vector<std::uint64_t> out;
  for (const Vertex& v : vertices) {
    const glm::dvec3 p = glm::floor(placed(one, v) / cell);
    if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 4e18)) continue;
    const std::uint64_t hash =
        hash_of({static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y),
                 static_cast<std::int64_t>(p.z)});
    if (vertices.size() <= kWholeMesh || hash % kOneIn == 0) out.push_back(hash);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// True if the mesh has two triangles on the same three corners, to the bit.
bool repeats_itself(const Mesh& mesh) {
  std::vector<std::uint64_t> places;
  places.reserve(mesh.vertices.size());
  for (const Vertex& v : mesh.vertices) {
    const glm::vec3 p = v.position + glm::vec3(0);  // -0 is 0
    places.push_back(mixed(XXH3_64bits(&p, sizeof p)));
  }
  std::vector<std::uint64_t> triangles;
  triangles.reserve(mesh.indices.size() / 3);
  for (const Primitive& p : mesh.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) continue;
    for (std::uint32_t i = 0; i + 2 < p.index_count; i += 3) {
      const std::uint32_t* corner = &mesh.indices[p.first_index + i];
      triangles.push_back(places[corner[0]] + places[corner[1]] + places[corner[2]]);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return std::adjacent_find(triangles.begin(), triangles.end()) != triangles.end();
}

// Sets of instances that are to be compared.
using Sets = std::vector<std::vector<std::uint32_t>>;

// Joins instances that share enough places, and finds meshes that repeat themselves.
class SetFinder {
 public:
  SetFinder(const Scene& scene, const std::vector<double>& extents)
      : scene_(scene), parent_(scene.instances.size()) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    double extent = 0;
    for (const Instance& one : scene.instances) {
      const glm::dvec3 at = glm::abs(one.world_from_object.position);
      const double own = extents[one.object] * double{one.world_from_object.scale};
      extent = std::max({extent, at.x + own, at.y + own, at.z + own});
    }
    cell_ = 1e-6 * extent;
  }

  Sets find() {
    if (cell_ > 0 && std::isfinite(cell_)) join_copies();
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_root;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) by_root[root(i)].push_back(i);
    Sets out;
    std::vector<std::int8_t> repeats(scene_.objects.size(), -1);
    for (auto& [first, set] : by_root) {
      const std::uint32_t object = scene_.instances[first].object;
      if (!takes_part(scene_.objects[object])) continue;
      if (set.size() == 1) {
        std::int8_t& known = repeats[object];
        if (known < 0) known = repeats_itself(scene_.objects[object].mesh) ? 1 : 0;
        if (known == 0) continue;
      }
      out.push_back(std::move(set));
    }
    return out;
  }

 private:
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join_copies() {
    std::vector<std::size_t> instances_of(scene_.objects.size());
    for (const Instance& one : scene_.instances) ++instances_of[one.object];
    std::vector<std::pair<std::uint64_t, std::uint32_t>> seen;  // cell, instance
    std::vector<std::size_t> places(scene_.instances.size());
    std::size_t looked_at = 0;
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const std::uint32_t index = scene_.instances[i].object;
      const SceneObject& object = scene_.objects[index];
      const std::size_t count = object.mesh.vertices.size();
      if (!takes_part(object) || count * instances_of[index] > kMostPlacesOfOne) continue;
      looked_at += count;
      if (looked_at > kMostPlaces) return;
      const std::vector<std::uint64_t> cells =
          cells_of(scene_.instances[i], object.mesh.vertices, cell_);
      places[i] = cells.size();
      for (const std::uint64_t cell : cells) seen.emplace_back(cell, i);
    }
    std::sort(seen.begin(), seen.end());
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> shared;
    for (std::size_t first = 0, last = 0; first < seen.size(); first = last) {
      while (last < seen.size() && seen[last].first == seen[first].first) ++last;
      if (last - first > kMostAtOnePlace) continue;
      for (std::size_t a = first; a < last; ++a) {
        for (std::size_t b = a + 1; b < last; ++b) ++shared[{seen[a].second, seen[b].second}];
      }
    }
    for (const auto& [pair, count] : shared) {
      const auto least = static_cast<double>(std::min(places[pair.first], places[pair.second]));
      if (static_cast<double>(count) < kShared * least) continue;
      const std::uint32_t a = root(pair.first), b = root(pair.second);
      parent_[std::max(a, b)] = std::min(a, b);
    }
  }

  const Scene& scene_;
  std::vector<std::uint32_t> parent_;
  double cell_ = 0;
};

class CoveredSurfaces {
 public:
  explicit CoveredSurfaces(Scene& scene)
      : scene_(scene),
        extents_(extents_of(scene)),
        hidden_(scene.instances.size()),
        without_area_(scene.instances.size()),
        used_before_(scene.objects.size(), false) {
    for (const Instance& one : scene.instances) used_before_[one.object] = true;
  }

  Covered leave_out() {
    for (const std::vector<std::uint32_t>& set : SetFinder(scene_, extents_).find()) compare(set);
    cut_meshes();
    remove_instances();
    return std::move(out_);
  }

 private:
  void compare(const std::vector<std::uint32_t>& set);
  void lay_out(std::uint32_t instance, const glm::dvec3& origin, Places& places,
               std::vector<Laid>& out);
  void mark(std::vector<Laid>::const_iterator first, std::vector<Laid>::const_iterator last);
  std::uint32_t base_without(std::uint32_t base, const std::vector<Hidden>& hidden);
  void cut_meshes();
  bool all_hidden(std::uint32_t instance) const;
  std::uint32_t single_sided(std::uint32_t material);
  void remove_instances();

  Scene& scene_;
  const std::vector<double> extents_;
  std::vector<std::vector<Hidden>> hidden_;              // by instance, in the order of triangles
  std::vector<std::size_t> without_area_;                // by instance: triangles that show nothing
  std::vector<bool> used_before_;                        // by object, of those in the file
  std::map<std::uint32_t, std::uint32_t> single_sided_;  // by material
  std::map<std::pair<std::uint32_t, std::vector<Hidden>>, std::uint32_t> bases_;
  std::uint32_t next_base_ = 0;
  std::size_t compared_ = 0;
  Covered out_;
};

// Marks the triangles of these instances that a later one covers.
void CoveredSurfaces::compare(const std::vector<std::uint32_t>& set) {
  double same = 0;
  for (const std::uint32_t i : set) {
    const Instance& one = scene_.instances[i];
    const glm::dvec3 at = glm::abs(one.world_from_object.position);
    same = std::max({same, kSame * extents_[one.object] * double{one.world_from_object.scale},
                     4e-16 * std::max({at.x, at.y, at.z})});
    compared_ += scene_.objects[one.object].mesh.indices.size() / 3;
  }
  if (!(same > 0) || !std::isfinite(same) || compared_ > kMostCompared) return;
  // Places are relative to the first instance, so that they count few cells.
  const glm::dvec3 origin = scene_.instances[set.front()].world_from_object.position;
  Places places(same);
  std::vector<Laid> laid;
  for (const std::uint32_t i : set) lay_out(i, origin, places, laid);
  std::sort(laid.begin(), laid.end());
  for (auto first = laid.cbegin(); first != laid.cend();) {
    const auto last = std::find_if(first, laid.cend(),
                                   [&](const Laid& one) { return one.corners != first->corners; });
    mark(first, last);
    first = last;
  }
}

void CoveredSurfaces::lay_out(std::uint32_t instance, const glm::dvec3& origin, Places& places,
                              std::vector<Laid>& out) {
  const Instance& one = scene_.instances[instance];
  const Mesh& mesh = scene_.objects[one.object].mesh;
  std::vector<std::uint32_t> numbers;
  numbers.reserve(mesh.vertices.size());
  for (const Vertex& v : mesh.vertices) numbers.push_back(places.number(placed(one, v) - origin));
  for (const Primitive& p : mesh.primitives) {
    const Material& m = scene_.materials[p.material];
    const bool blends = m.alpha_mode == AlphaMode::kBlend || m.lobes.transmission > 0;
    if (p.kind != PrimitiveKind::kTriangles || blends) continue;
    for (std::uint32_t k = p.first_index; k + 2 < p.first_index + p.index_count; k += 3) {
      Laid laid;
      laid.instance = instance;
      laid.triangle = k / 3;
      laid.covers = m.alpha_mode == AlphaMode::kOpaque;
      laid.two_sided = m.double_sided;
      auto& c = laid.corners;
      c = {numbers[mesh.indices[k]], numbers[mesh.indices[k + 1]], numbers[mesh.indices[k + 2]]};
      if (c[0] == c[1] || c[1] == c[2] || c[0] == c[2]) {
        ++without_area_[instance];
        continue;
      }
      std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
      laid.turned = c[1] > c[2];
      if (laid.turned) std::swap(c[1], c[2]);
      out.push_back(laid);
    }
  }
}

// Marks triangles on the same corners, given in the order in which they are drawn.
void CoveredSurfaces::mark(std::vector<Laid>::const_iterator first,
                           std::vector<Laid>::const_iterator last) {
  std::array<bool, 2> covered{};  // as seen from either side, by what comes later
  for (auto it = last; it != first;) {
    --it;
    const std::size_t front = it->turned ? 1 : 0, back = 1 - front;
    const bool hides_front = covered[front], hides_back = covered[back] && it->two_sided;
    if (hides_front || hides_back) {
      const bool no_back = hides_back || !it->two_sided;
      const int sides = (hides_front ? kFront : 0) | (no_back ? kBack : 0);
      hidden_[it->instance].push_back({it->triangle, static_cast<std::uint8_t>(sides)});
    }
    if (!it->covers) continue;
    covered[front] = true;
    if (it->two_sided) covered[back] = true;
  }
}

bool CoveredSurfaces::all_hidden(std::uint32_t instance) const {
  const std::vector<Hidden>& hidden = hidden_[instance];
  const Mesh& mesh = scene_.objects[scene_.instances[instance].object].mesh;
  return !hidden.empty() && 3 * (hidden.size() + without_area_[instance]) == mesh.indices.size() &&
         std::all_of(hidden.begin(), hidden.end(),
                     [](const Hidden& one) { return one.sides == kBoth; });
}

std::uint32_t CoveredSurfaces::single_sided(std::uint32_t material) {
  const auto next = static_cast<std::uint32_t>(scene_.materials.size());
  const auto [at, is_new] = single_sided_.try_emplace(material, next);
  if (is_new) {
    Material form = scene_.materials[material];
    form.double_sided = false;
    scene_.materials.push_back(std::move(form));
    out_.materials.push_back(material);
  }
  return at->second;
}

// Returns the base of meshes that are baked from `base` without what is hidden. Those of which the
// same is hidden still differ by their shapes only.
std::uint32_t CoveredSurfaces::base_without(std::uint32_t base, const std::vector<Hidden>& hidden) {
  if (next_base_ == 0) {
    for (const SceneObject& object : scene_.objects) {
      if (object.baked) next_base_ = std::max(next_base_, object.baked->base + 1);
    }
  }
  const auto [at, is_new] = bases_.try_emplace(std::pair{base, hidden}, next_base_);
  if (is_new) ++next_base_;
  return at->second;
}

// Gives instances of which the same is hidden an object without it.
void CoveredSurfaces::cut_meshes() {
  std::map<std::uint32_t, std::vector<std::uint32_t>> instances;  // by object
  for (std::uint32_t i = 0; i < hidden_.size(); ++i) {
    std::sort(hidden_[i].begin(), hidden_[i].end(),
              [](const Hidden& a, const Hidden& b) { return a.triangle < b.triangle; });
    instances[scene_.instances[i].object].push_back(i);
  }
  for (const auto& [object, all] : instances) {
    const std::size_t triangles = scene_.objects[object].mesh.indices.size() / 3;
    std::vector<std::uint32_t> left;
    for (const std::uint32_t i : all) {
      const bool few = kWorthACopy * hidden_[i].size() < triangles;
      if (hidden_[i].empty() || all_hidden(i) || (few && all.size() > 1)) continue;
      left.push_back(i);
    }
    while (!left.empty()) {
      const std::vector<Hidden> hidden = hidden_[left.front()];
      const auto rest = std::stable_partition(
          left.begin(), left.end(), [&](std::uint32_t i) { return hidden_[i] == hidden; });
      SceneObject form = scene_.objects[object];
      form.mesh =
          MeshCut(form.mesh, [this](std::uint32_t m) { return single_sided(m); }).without(hidden);
      if (form.baked) form.baked->base = base_without(form.baked->base, hidden);
      for (auto it = left.begin(); it != rest; ++it) {
        scene_.instances[*it].object = static_cast<std::uint32_t>(scene_.objects.size());
        out_.triangles += hidden.size();
        hidden_[*it].clear();
      }
      scene_.objects.push_back(std::move(form));
      left.erase(left.begin(), rest);
    }
  }
}

// Removes instances of which nothing is seen, and objects that have lost all their instances.
void CoveredSurfaces::remove_instances() {
  std::vector<bool> used(scene_.objects.size(), false);
  std::vector<Instance> kept;
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    if (all_hidden(i)) {
      ++out_.instances;
      continue;
    }
    kept.push_back(scene_.instances[i]);
    used[kept.back().object] = true;
  }
  scene_.instances = std::move(kept);
  std::vector<std::uint32_t> place;
  std::vector<SceneObject> objects;
  for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
    place.push_back(static_cast<std::uint32_t>(objects.size()));
    const bool lost = i < used_before_.size() && used_before_[i] && !used[i];
    if (!lost) objects.push_back(std::move(scene_.objects[i]));
  }
  scene_.objects = std::move(objects);
  for (Instance& one : scene_.instances) one.object = place[one.object];
}

}  // namespace

Covered leave_out_covered(Scene& scene) { return CoveredSurfaces(scene).leave_out(); }

}  // namespace mirage

#include "server/prepare/grouping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "protocol/model/need_mask.h"
#include "server/prepare/world_box.h"

namespace mirage {
namespace {

constexpr float kHidesAll = 0.99f;  // alpha from which a surface hides everything behind it
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kFewInstances = 32;  // fewer are not worth a group
// Nested groups differ in size by a factor of four. The smallest have few enough instances to be
// told apart from near by; the largest are those whose image a server draws in a fraction of a
// second. There are at least as many of the largest as a view from the ground shows, so no scene is
// a single group.
constexpr std::size_t kSmallestGroup = 4;
constexpr std::size_t kLargestGroup = 256;
constexpr std::size_t kLargestOfAll = 4096;
constexpr std::size_t kManyGroups = 256;
// relative to the scene's radius; larger objects are not grouped
constexpr double kLargeShare = 0.1;
constexpr std::size_t kSurroundedInstances = 16;
constexpr std::uint32_t kMaxSurroundingTriangles = 100'000;

// The contribution of an instance to its groups; lengths in world space.
struct Extent {
  glm::dvec3 center{0};  // of its sphere
  glm::dvec3 low{kInfinity}, high{-kInfinity};
  void add(const Extent& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
};

Extent extent_of(const Instance& instance, const ObjectDescription& object) {
  const Similarity& m = instance.world_from_object;
  const glm::dmat3 turn = glm::mat3_cast(glm::dquat(m.rotation)) * double{m.scale};
  Extent out;
  out.center = m.position + turn * glm::dvec3(object.center);
  const WorldBox box = world_box(instance, object);
  out.low = box.low;
  out.high = box.high;
  return out;
}

// Sums over the members of a group.
struct Sum {
  Extent extent;
  glm::dvec3 color{0};
  double area = 0;
  NeedMask needs = 0;
  Importance importance = Importance::kScenery;
  void add(const Sum& other) {
    extent.add(other.extent);
    color += other.color;
    area += other.area;
    needs |= other.needs;
    importance = std::max(importance, other.importance);
  }
};

GroupBounds bounds_of(const Sum& sum) {
  GroupBounds out = GroupBounds::around(sum.extent.low, sum.extent.high);
  out.set_mean_color(sum.area > 0 ? glm::vec3(sum.color / sum.area) : glm::vec3(0));
  out.needs = sum.needs;
  return out;
}

class Grouper {
 public:
  Grouper(Scene& scene, const std::vector<ObjectDescription>& objects)
      : scene_(scene), objects_(objects) {
    extents_.reserve(scene.instances.size());
    for (const Instance& i : scene.instances) {
      extents_.push_back(extent_of(i, objects[i.object]));
    }
  }

  Grouping build() {
    const std::vector<std::uint32_t> loose = collect();
    first_leaf_ = loose.size();
    if (order_.size() < kFewInstances) return no_groups(extents_.size());
    std::size_t largest = kLargestGroup;
    while (largest < kLargestOfAll && order_.size() / largest > kManyGroups) largest *= 4;
    out_.group_of.assign(extents_.size(), kNoGroup);
    split(0, order_.size(), kNoGroup, largest);
    renumber(loose);
    list_members();
    return std::move(out_);
  }

 private:
  // Fills order_ with the instances that may be grouped; returns the rest.
  std::vector<std::uint32_t> collect() {
    Extent whole;
    for (const Extent& e : extents_) {
      whole.low = glm::min(whole.low, e.center);
      whole.high = glm::max(whole.high, e.center);
    }
    const double scene_radius = 0.5 * glm::length(whole.high - whole.low);
    std::vector<std::uint32_t> loose;
    for (std::uint32_t i = 0; i < extents_.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      const ObjectDescription& object = objects_[instance.object];
      const double radius = double{object.radius} * instance.world_from_object.scale;
      const bool one_of_many = radius > 0 && radius <= kLargeShare * scene_radius;
      const bool one_picture = !(object.needs & kNeedBlend) && !object.moves();
      const bool grouped = one_of_many && !object.surrounds && one_picture;
      (grouped ? order_ : loose).push_back(i);
    }
    return loose;
  }

  // Halves [first, last) at the median of its longest side. A cell of at most `size` becomes a
  // group.
  Sum split(std::size_t first, std::size_t last, std::uint32_t parent, std::size_t size) {
    const std::size_t count = last - first;
    std::uint32_t group = kNoGroup;
    if (count <= size && count > kSmallestGroup / 2) {
      group = static_cast<std::uint32_t>(out_.groups.size());
      InstanceGroup added;
      added.first_leaf = static_cast<std::uint32_t>(first_leaf_ + first);
      added.leaves = static_cast<std::uint32_t>(count);
      added.parent = parent;
      out_.groups.push_back(added);
      parent = group;
      size /= 4;
    }
    Sum sum;
    if (size < kSmallestGroup || count <= kSmallestGroup / 2) {
      const auto at = order_.begin();
      std::sort(at + static_cast<std::ptrdiff_t>(first), at + static_cast<std::ptrdiff_t>(last));
      for (std::size_t i = first; i < last; ++i) {
        out_.group_of[first_leaf_ + i] = parent;
        sum.add(sum_of(order_[i]));
      }
    } else {
      const std::size_t middle = first + count / 2;
      halve(first, middle, last);
      sum = split(first, middle, parent, size);
      sum.add(split(middle, last, parent, size));
    }
    if (group != kNoGroup) {
      out_.groups[group].bounds = bounds_of(sum);
      out_.groups[group].importance = sum.importance;
    }
    return sum;
  }

  void halve(std::size_t first, std::size_t middle, std::size_t last) {
    glm::dvec3 low(kInfinity), high(-kInfinity);
    for (std::size_t i = first; i < last; ++i) {
      low = glm::min(low, extents_[order_[i]].center);
      high = glm::max(high, extents_[order_[i]].center);
    }
    const glm::dvec3 side = high - low;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const auto at = [this](std::size_t i) {
      return order_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t a, std::uint32_t b) {
      const double ca = extents_[a].center[axis], cb = extents_[b].center[axis];
      // ties are broken by index, so every machine builds the same tree
      return ca != cb ? ca < cb : a < b;
    });
  }

  Sum sum_of(std::uint32_t i) const {
    const Instance& instance = scene_.instances[i];
    const ObjectDescription& object = objects_[instance.object];
    Sum out;
    out.extent = extents_[i];
    out.area = std::pow(double{object.radius} * instance.world_from_object.scale, 2);
    out.color = glm::dvec3(object.mean_color) * out.area;
    out.needs = object.needs;
    out.importance = instance.importance;
    return out;
  }

  void renumber(const std::vector<std::uint32_t>& loose) {
    std::vector<Instance> instances;
    instances.reserve(scene_.instances.size());
    for (const std::uint32_t i : loose) instances.push_back(scene_.instances[i]);
    for (const std::uint32_t i : order_) instances.push_back(scene_.instances[i]);
    scene_.instances = std::move(instances);
  }

  void list_members() {
    const auto own = static_cast<std::uint32_t>(scene_.instances.size());
    const std::size_t groups = out_.groups.size();
    const auto parent_of = [&](std::uint32_t i) {
      return i < own ? out_.group_of[i] : out_.groups[i - own].parent;
    };
    const auto all = own + static_cast<std::uint32_t>(groups);
    for (std::uint32_t i = 0; i < all; ++i) {
      if (const std::uint32_t parent = parent_of(i); parent != kNoGroup) {
        ++out_.groups[parent].members;
      } else {
        out_.roots.push_back(i);
      }
    }
    std::uint32_t next = 0;
    for (InstanceGroup& group : out_.groups) {
      group.first_member = next;
      next += group.members;
      group.members = 0;
    }
    out_.members.resize(next);
    for (std::uint32_t i = 0; i < all; ++i) {
      if (const std::uint32_t parent = parent_of(i); parent != kNoGroup) {
        InstanceGroup& group = out_.groups[parent];
        out_.members[group.first_member + group.members++] = i;
      }
    }
  }

  Scene& scene_;
  const std::vector<ObjectDescription>& objects_;
  Grouping out_;
  std::vector<Extent> extents_;
  std::vector<std::uint32_t> order_;
  std::size_t first_leaf_ = 0;
};

}  // namespace

Grouping no_groups(std::size_t instances) {
  Grouping out;
  out.group_of.assign(instances, kNoGroup);
  out.roots.resize(instances);
  std::iota(out.roots.begin(), out.roots.end(), 0u);
  return out;
}

Grouping group_instances(Scene& scene, const std::vector<ObjectDescription>& objects) {
  return Grouper(scene, objects).build();
}

namespace {

// Returns the centre of the object's bounding sphere in the world.
glm::dvec3 middle_of(const Instance& instance, const ObjectDescription& object) {
  const Similarity& m = instance.world_from_object;
  return m.position + glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale});
}

bool in_box(const glm::dvec3& world, const Instance& instance, const ObjectDescription& object) {
  const Similarity& m = instance.world_from_object;
  const glm::dvec3 p =
      glm::conjugate(glm::dquat(m.rotation)) * (world - m.position) / double{m.scale};
  return glm::all(glm::greaterThan(p, glm::dvec3(object.box_min))) &&
         glm::all(glm::lessThan(p, glm::dvec3(object.box_max)));
}

// True for glass: no part of the surface hides everything behind it. Foliage with soft-edged
// textures gives false.
bool seen_through(const Scene& scene, const SceneObject& object) {
  const std::vector<Primitive>& primitives = object.mesh.primitives;
  return std::any_of(primitives.begin(), primitives.end(), [&](const Primitive& p) {
    const Material& material = scene.materials[p.material];
    return material.alpha_mode == AlphaMode::kBlend && material.base_color.a < kHidesAll;
  });
}

// Marks see-through objects whose box contains the middle of another object.
void find_vitrines(const Scene& scene, std::vector<ObjectDescription>& objects) {
  std::vector<std::pair<double, glm::dvec3>> middles;  // by x
  for (const Instance& i : scene.instances) {
    const glm::dvec3 at = middle_of(i, objects[i.object]);
    middles.emplace_back(at.x, at);
  }
  std::sort(middles.begin(), middles.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const Instance& i : scene.instances) {
    ObjectDescription& object = objects[i.object];
    const bool vitrine = (object.needs & kNeedBlend) && !object.surrounds &&
                         seen_through(scene, scene.objects[i.object]) &&
                         object.triangles <= kMaxSurroundingTriangles;
    if (!vitrine) continue;
    const glm::dvec3 own = middle_of(i, object);
    const double radius = double{object.radius} * i.world_from_object.scale;
    auto at = std::lower_bound(middles.begin(), middles.end(), own.x - radius,
                               [](const auto& m, double x) { return m.first < x; });
    for (; at != middles.end() && at->first <= own.x + radius && !object.surrounds; ++at) {
      object.surrounds = at->second != own && in_box(at->second, i, object);
    }
  }
}

void find_shells(const Scene& scene, double bounds_radius,
                 std::vector<ObjectDescription>& objects) {
  if (scene.instances.size() < kSurroundedInstances) return;
  std::vector<std::uint32_t> uses(objects.size(), 0);
  for (const Instance& i : scene.instances) ++uses[i.object];
  // An object this large, in a scene of several, surrounds the viewer.
  for (const Instance& i : scene.instances) {
    ObjectDescription& object = objects[i.object];
    const double radius = double{object.radius} * i.world_from_object.scale;
    // An object that goes away, or is hidden at times, is no place.
    const bool stays = !object.track.moves() && object.motion.hidden.empty();
    object.surrounds = uses[i.object] == 1 && stays && radius > kLargeShare * bounds_radius &&
                       object.triangles <= kMaxSurroundingTriangles;
  }
}

}  // namespace

void find_surroundings(const Scene& scene, double bounds_radius,
                       std::vector<ObjectDescription>& objects) {
  find_shells(scene, bounds_radius, objects);
  find_vitrines(scene, objects);
}

}  // namespace mirage

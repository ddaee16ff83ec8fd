#include "server/scene/grouping.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/scene/convex_hull.h"

namespace mirage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kFewInstances = 32;  // not worth a group
// Nested groups are a factor of four apart in size; a large scene has larger ones, so that their
// description stays small.
constexpr std::size_t kSmallestGroup = 4;
constexpr std::size_t kGroupSizes = 4;
constexpr std::size_t kMostSmallest = 2048;
constexpr double kLargeShare = 0.1;  // of the scene's radius: too large to be one of many
constexpr std::size_t kSurroundedInstances = 16;
constexpr std::uint32_t kMaxSurroundingTriangles = 100'000;

glm::dvec3 world_center(const Instance& instance, const ObjectDescription& object) {
  const Similarity& m = instance.world_from_object;
  return m.position + glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale});
}

class Grouper {
 public:
  Grouper(const Scene& scene, const std::vector<ObjectDescription>& objects, Grouping& out)
      : scene_(scene), objects_(objects), out_(out) {
    for (const Instance& i : scene.instances)
      centers_.push_back(world_center(i, objects[i.object]));
  }

  void collect() {
    glm::dvec3 low(kInfinity), high(-kInfinity);
    for (const glm::dvec3& c : centers_) {
      low = glm::min(low, c);
      high = glm::max(high, c);
    }
    const double scene_radius = 0.5 * glm::length(high - low);
    for (std::uint32_t i = 0; i < centers_.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      const ObjectDescription& object = objects_[instance.object];
      const double radius = double{object.radius} * instance.world_from_object.scale;
      const bool one_of_many = radius > 0 && radius <= kLargeShare * scene_radius;
      const bool one_picture = !(object.needs & kNeedBlend) && !object.motion.moving();
      if (one_of_many && !object.surrounds && one_picture) order_.push_back(i);
    }
  }

  void build() {
    if (order_.size() < kFewInstances) return;
    while (smallest_ * kMostSmallest < order_.size()) smallest_ *= 2;
    split(0, order_.size(), kNoGroup, smallest_ << (2 * (kGroupSizes - 1)));
  }

 private:
  // Halves [first, last) at the median of its longest side; a cell of at most `size` is a group.
  void split(std::size_t first, std::size_t last, std::uint32_t parent, std::size_t size) {
    const std::size_t count = last - first;
    if (count <= size && count > smallest_ / 2) {
      parent = add_group(first, last, parent);
      size /= 4;
    }
    if (size < smallest_ || count <= smallest_ / 2) {
      for (std::size_t i = first; i < last; ++i) out_.group_of[order_[i]] = parent;
      return;
    }
    glm::dvec3 low(kInfinity), high(-kInfinity);
    for (std::size_t i = first; i < last; ++i) {
      low = glm::min(low, centers_[order_[i]]);
      high = glm::max(high, centers_[order_[i]]);
    }
    const glm::dvec3 side = high - low;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const std::size_t middle = first + count / 2;
    const auto at = [this](std::size_t i) {
      return order_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t a, std::uint32_t b) {
      const double ca = centers_[a][axis], cb = centers_[b][axis];
      return ca != cb ? ca < cb : a < b;  // the same tree wherever it is built
    });
    split(first, middle, parent, size);
    split(middle, last, parent, size);
  }

  std::uint32_t add_group(std::size_t first, std::size_t last, std::uint32_t parent) {
    InstanceGroup group;
    group.parent = parent;
    for (std::size_t i = first; i < last; ++i) group.leaves.push_back(order_[i]);
    std::sort(group.leaves.begin(), group.leaves.end());
    glm::dvec3 low(kInfinity), high(-kInfinity);
    for (const std::uint32_t i : group.leaves) {
      const Instance& instance = scene_.instances[i];
      const double r = double{objects_[instance.object].radius} * instance.world_from_object.scale;
      low = glm::min(low, centers_[i] - r);
      high = glm::max(high, centers_[i] + r);
      group.importance = std::max(group.importance, instance.importance);
    }
    group.center = 0.5 * (low + high);
    out_.groups.push_back(std::move(group));
    return static_cast<std::uint32_t>(out_.groups.size() - 1);
  }

  const Scene& scene_;
  const std::vector<ObjectDescription>& objects_;
  Grouping& out_;
  std::vector<glm::dvec3> centers_;
  std::vector<std::uint32_t> order_;
  std::size_t smallest_ = kSmallestGroup;
};

}  // namespace

Grouping group_instances(const Scene& scene, const std::vector<ObjectDescription>& objects) {
  Grouping out;
  out.group_of.assign(scene.instances.size(), kNoGroup);
  Grouper grouper(scene, objects, out);
  grouper.collect();
  grouper.build();
  return out;
}

ObjectDescription describe_group(const InstanceGroup& group, const Scene& scene,
                                 const std::vector<ObjectDescription>& objects) {
  ObjectDescription out;
  out.group = true;
  std::vector<glm::vec3> corners;
  glm::dvec3 color(0);
  double weight = 0, radius = 0;
  for (const std::uint32_t i : group.leaves) {
    const Similarity& m = scene.instances[i].world_from_object;
    const ObjectDescription& object = objects[scene.instances[i].object];
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec3 p(corner & 1 ? object.box_max.x : object.box_min.x,
                        corner & 2 ? object.box_max.y : object.box_min.y,
                        corner & 4 ? object.box_max.z : object.box_min.z);
      const glm::dvec3 world =
          m.position - group.center + glm::dquat(m.rotation) * (glm::dvec3(p) * double{m.scale});
      corners.emplace_back(world);
      radius = std::max(radius, glm::length(world));
    }
    const double area = std::pow(double{object.radius} * m.scale, 2);
    color += glm::dvec3(object.mean_color) * area;
    weight += area;
    out.needs |= object.needs;
    out.triangles += object.triangles;
  }
  out.box_min = out.box_max = corners[0];
  for (const glm::vec3& p : corners) {
    out.box_min = glm::min(out.box_min, p);
    out.box_max = glm::max(out.box_max, p);
  }
  out.radius = static_cast<float>(radius * 1.00001);
  if (weight > 0) out.mean_color = glm::vec3(color / weight);
  if (Result<ConvexHull> hull = enclosing_hull(corners); hull.ok()) out.hull = hull.take();
  return out;
}

void find_surroundings(const Scene& scene, double bounds_radius,
                       std::vector<ObjectDescription>& objects) {
  if (scene.instances.size() < kSurroundedInstances) return;
  std::vector<std::uint32_t> uses(objects.size(), 0);
  for (const Instance& i : scene.instances) ++uses[i.object];
  // An object of this share of the scene's radius, in a scene of several, is what one stands in.
  for (const Instance& i : scene.instances) {
    ObjectDescription& object = objects[i.object];
    const double radius = double{object.radius} * i.world_from_object.scale;
    object.surrounds = uses[i.object] == 1 && radius > kLargeShare * bounds_radius &&
                       object.triangles <= kMaxSurroundingTriangles;
  }
}

}  // namespace mirage

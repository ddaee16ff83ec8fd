#include "server/prepare/touching.h"

#include <algorithm>

#include "server/prepare/world_box.h"

namespace mirage {
namespace {

constexpr double kReach = 1.0 / 32;  // of the radius: depth error of a tile of 128 texels
constexpr double kMostLarger = 2;    // radius of an instance, relative to that of the object
constexpr double kBoxWidth = 3.5;    // widest box of a turned box in a sphere of radius 1
// A tile draws the depth of what touches its object, so that must stay cheap beside the object.
constexpr std::size_t kMostOthers = 32;

struct Candidate {
  std::uint32_t instance = 0;
  double radius = 0;  // metres
  WorldBox box;
};

bool meet(const WorldBox& a, const WorldBox& b, double margin) {
  return glm::all(glm::lessThanEqual(a.low - margin, b.high)) &&
         glm::all(glm::lessThanEqual(b.low - margin, a.high));
}

// Returns all that stands still and has a tile of its own, by the lower end along x.
std::vector<Candidate> candidates(const Scene& scene,
                                  const std::vector<ObjectDescription>& objects) {
  std::vector<Candidate> out;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const ObjectDescription& object = objects[instance.object];
    if (object.moves() || object.surrounds || !(object.radius > 0)) continue;
    out.push_back(
        {i, double{object.radius} * instance.world_from_object.scale, world_box(instance, object)});
  }
  std::stable_sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    return a.box.low.x < b.box.low.x;
  });
  return out;
}

std::uint64_t triangles(const Scene& scene, std::uint32_t instance) {
  return scene.objects[scene.instances[instance].object].mesh.indices.size() / 3;
}

// Returns the ungrouped instances that hide a part of a group: ground under grass.
std::vector<std::uint32_t> ground_of(const Scene& scene,
                                     const std::vector<ObjectDescription>& objects,
                                     const std::vector<std::uint32_t>& ungrouped,
                                     const InstanceGroup& group) {
  const glm::dvec3 half(group.bounds.half);
  const WorldBox own{group.bounds.center - half, group.bounds.center + half};
  std::uint64_t left = 0;  // triangles: the depth of the others is to be as cheap as the group
  for (std::uint32_t i = 0; i < group.leaves; ++i) left += triangles(scene, group.first_leaf + i);
  std::vector<std::uint32_t> out;
  for (const std::uint32_t other : ungrouped) {
    const Instance& instance = scene.instances[other];
    if (!meet(own, world_box(instance, objects[instance.object]), 0) ||
        triangles(scene, other) > left || out.size() == kMostOthers) {
      continue;
    }
    left -= triangles(scene, other);
    out.push_back(other);
  }
  return out;
}

}  // namespace

std::vector<Touching> find_touching(const Scene& scene,
                                    const std::vector<ObjectDescription>& objects,
                                    const Grouping& grouping) {
  std::vector<Touching> out(objects.size());
  std::vector<std::uint32_t> uses(objects.size(), 0);
  for (const Instance& i : scene.instances) ++uses[i.object];
  const std::vector<Candidate> all = candidates(scene, objects);
  for (const Candidate& own : all) {
    const std::uint32_t object = scene.instances[own.instance].object;
    if (uses[object] != 1 || grouping.group_of[own.instance] != kNoGroup ||
        layered(objects[object].needs)) {
      continue;
    }
    out[object].instance = own.instance;
    std::vector<std::uint32_t>& others = out[object].others;
    const double margin = kReach * own.radius, widest = kBoxWidth * kMostLarger * own.radius;
    auto other = std::lower_bound(all.begin(), all.end(), own.box.low.x - margin - widest,
                                  [](const Candidate& c, double x) { return c.box.low.x < x; });
    for (; other != all.end() && other->box.low.x <= own.box.high.x + margin; ++other) {
      if (other->instance != own.instance && other->radius <= kMostLarger * own.radius &&
          others.size() < kMostOthers && meet(own.box, other->box, margin)) {
        others.push_back(other->instance);
      }
    }
    std::sort(others.begin(), others.end());
  }
  std::vector<std::uint32_t> ungrouped;  // that hide what is behind them
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const ObjectDescription& object = objects[scene.instances[i].object];
    const bool hides = !object.moves() && !(object.needs & kNeedBlend);
    if (hides && grouping.group_of[i] == kNoGroup) ungrouped.push_back(i);
  }
  for (const InstanceGroup& group : grouping.groups) {
    Touching& of_group = out.emplace_back();
    if (group.part == kNoGroup) of_group.others = ground_of(scene, objects, ungrouped, group);
  }
  return out;
}

}  // namespace mirage

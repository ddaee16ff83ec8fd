#include "server/prepare/instance_parts.h"

#include <limits>

#include "server/prepare/cut_mesh.h"
#include "server/prepare/object_description.h"

namespace mirage {
namespace {

constexpr double kLargePart = 0.1;  // relative to the scene's radius
constexpr std::uint32_t kFewestTriangles = 2;
// Above these limits, parts cost more memory and loading time than they are worth.
constexpr std::uint32_t kMostTriangles = 1'000'000;
constexpr std::size_t kMostCuts = 16;

GroupBounds bounds_of(const Mesh& part, const Similarity& world_from_object) {
  const glm::dmat3 turn =
      glm::mat3_cast(glm::dquat(world_from_object.rotation)) * double{world_from_object.scale};
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Vertex& v : part.vertices) {
    const glm::dvec3 p = world_from_object.position + turn * glm::dvec3(v.position);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return GroupBounds::around(low, high);
}

bool worth_cutting(const Instance& instance, const ObjectDescription& object,
                   double bounds_radius) {
  const double radius = double{object.radius} * instance.world_from_object.scale;
  return radius > kLargePart * bounds_radius && object.triangles >= kFewestTriangles &&
         object.triangles <= kMostTriangles && !object.moves() && !(object.needs & kNeedBlend);
}

}  // namespace

std::vector<Mesh> cut_instances(const Scene& scene, double bounds_radius,
                                std::vector<ObjectDescription>& objects, Grouping& grouping,
                                const Workers& workers) {
  std::vector<std::uint32_t> uses(objects.size(), 0);
  for (const Instance& i : scene.instances) ++uses[i.object];
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t i = 0; i < scene.instances.size() && chosen.size() < kMostCuts; ++i) {
    const Instance& instance = scene.instances[i];
    const bool once = uses[instance.object] == 1;
    if (once && worth_cutting(instance, objects[instance.object], bounds_radius)) {
      chosen.push_back(i);
    }
  }
  std::vector<std::vector<Mesh>> cut(chosen.size());
  workers.each(chosen.size(), [&](std::size_t k) {
    cut[k] = cut_mesh(scene.objects[scene.instances[chosen[k]].object].mesh, workers);
  });
  std::vector<Mesh> parts;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (cut[k].size() < 2) continue;
    const Instance& instance = scene.instances[chosen[k]];
    ObjectDescription& object = objects[instance.object];
    object.cut = true;
    grouping.cuts.push_back({chosen[k], static_cast<std::uint32_t>(grouping.groups.size()),
                             static_cast<std::uint32_t>(cut[k].size())});
    const auto colors = material_colors(scene.objects[instance.object].mesh, scene);
    for (Mesh& mesh : cut[k]) {
      InstanceGroup part;
      part.bounds = bounds_of(mesh, instance.world_from_object);
      part.bounds.set_mean_color(glm::vec3(mean_color(mesh, colors, scene.materials)));
      part.bounds.needs = object.needs;
      part.first_leaf = chosen[k];
      part.leaves = 1;
      part.importance = instance.importance;
      part.part = static_cast<std::uint32_t>(parts.size());
      grouping.groups.push_back(part);
      parts.push_back(std::move(mesh));
    }
  }
  return parts;
}

}  // namespace mirage

#include "server/scene/gltf/bounds.h"

#include <vector>

namespace mirage::gltf {

void Bounds::add(const glm::dvec3& point) {
  low = empty ? point : glm::min(low, point);
  high = empty ? point : glm::max(high, point);
  empty = false;
}

Bounds scene_bounds(const Scene& scene) {
  std::vector<Bounds> boxes(scene.objects.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    std::vector<Vertex> posed;
    if (object.animation) pose_vertices(object.mesh.vertices, *object.animation, 0, posed);
    for (const Vertex& vertex : object.animation ? posed : object.mesh.vertices) {
      boxes[i].add(glm::dvec3(vertex.position));
    }
  }
  Bounds all;
  for (const Instance& instance : scene.instances) {
    const Bounds& box = boxes[instance.object];
    if (box.empty) continue;
    const Similarity& world = instance.world_from_object;
    const glm::dquat turn(world.rotation);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 point((corner & 1) != 0 ? box.high.x : box.low.x,
                             (corner & 2) != 0 ? box.high.y : box.low.y,
                             (corner & 4) != 0 ? box.high.z : box.low.z);
      all.add(world.position + turn * (static_cast<double>(world.scale) * point));
    }
  }
  return all;
}

}  // namespace mirage::gltf

#include "server/scene/gltf/bounds.h"

#include <algorithm>
#include <vector>

namespace mirage::gltf {

void Bounds::add(const glm::dvec3& point) {
  low = empty ? point : glm::min(low, point);
  high = empty ? point : glm::max(high, point);
  empty = false;
}

std::vector<glm::vec3> shown_positions(const SceneObject& object) {
  constexpr int kPoses = 16;
  std::vector<glm::vec3> out;
  for (int i = 0; object.animation && i < kPoses; ++i) {
    const double time = object.animation->clip_s * static_cast<double>(i) / kPoses;
    pose_positions(object.mesh.vertices, *object.animation, time, out);
    const bool point =
        std::all_of(out.begin(), out.end(), [&](const glm::vec3& p) { return p == out.front(); });
    if (!point) return out;
  }
  out.clear();
  for (const Vertex& vertex : object.mesh.vertices) out.push_back(vertex.position);
  return out;
}

Bounds scene_bounds(const Scene& scene) {
  std::vector<Bounds> boxes(scene.objects.size());
  ShownPositions shown(scene);
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const auto vertices = static_cast<std::uint32_t>(scene.objects[i].mesh.vertices.size());
    for (std::uint32_t v = 0; v < vertices; ++v) boxes[i].add(glm::dvec3(shown.at(i, v)));
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

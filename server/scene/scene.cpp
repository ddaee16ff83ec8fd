#include "server/scene/scene.h"

namespace mirage {

std::uint64_t Scene::triangles() const {
  std::vector<std::uint64_t> per_object;
  per_object.reserve(objects.size());
  for (const SceneObject& object : objects) {
    std::uint64_t count = 0;
    for (const Primitive& primitive : object.mesh.primitives) {
      if (primitive.kind == PrimitiveKind::kTriangles) count += primitive.index_count / 3;
    }
    per_object.push_back(count);
  }
  std::uint64_t total = 0;
  for (const Instance& instance : instances) total += per_object[instance.object];
  return total;
}

}  // namespace mirage

#include "server/scene/scene.h"

#include <numeric>

namespace mirage {

namespace {

std::vector<std::uint64_t> triangles_by_object(const Scene& scene) {
  std::vector<std::uint64_t> out;
  out.reserve(scene.objects.size());
  for (const SceneObject& object : scene.objects) {
    std::uint64_t count = 0;
    for (const Primitive& primitive : object.mesh.primitives) {
      if (primitive.kind == PrimitiveKind::kTriangles) count += primitive.index_count / 3;
    }
    out.push_back(count);
  }
  return out;
}

}  // namespace

std::uint64_t Scene::triangles() const {
  const std::vector<std::uint64_t> by_object = triangles_by_object(*this);
  std::uint64_t total = 0;
  for (const Instance& instance : instances) total += by_object[instance.object];
  return total;
}

std::uint64_t Scene::own_triangles() const {
  const std::vector<std::uint64_t> by_object = triangles_by_object(*this);
  return std::accumulate(by_object.begin(), by_object.end(), std::uint64_t{0});
}

}  // namespace mirage

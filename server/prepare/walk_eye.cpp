#include "server/prepare/walk_eye.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/prepare/world_box.h"

namespace mirage {
namespace {

constexpr double kPerson = 1.7;                             // m
constexpr double kLowestEye = 0.5, kHighestEye = 3;         // m, of a home view at eye height
constexpr double kSmallestPlace = 3, kLargestPlace = 5000;  // radius, m, of scenes in metres
constexpr double kUsualPlace = 300;                         // radius, m
constexpr double kNoHit = std::numeric_limits<double>::infinity();

// The nearest surfaces that a plumb line through a point meets.
struct Plumb {
  double below = -kNoHit, above = kNoHit;  // height of the surface
};

// Adds a triangle, in world space, relative to the point.
void meet(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, Plumb& plumb) {
  const auto side = [](const glm::dvec3& p, const glm::dvec3& q) { return p.x * q.z - p.z * q.x; };
  const double u = side(b, c), v = side(c, a), w = side(a, b), area = u + v + w;
  const bool inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
  if (!inside || area == 0) return;
  const double height = (u * a.y + v * b.y + w * c.y) / area;
  if (height <= 0) plumb.below = std::max(plumb.below, height);
  if (height > 0) plumb.above = std::min(plumb.above, height);
}

void meet(const Mesh& mesh, const Scene& scene, const Similarity& m, const glm::dvec3& point,
          Plumb& plumb) {
  const glm::dmat3 turn = glm::mat3_cast(glm::dquat(m.rotation)) * double{m.scale};
  const auto at = [&](std::uint32_t i) {
    return m.position - point + turn * glm::dvec3(mesh.vertices[mesh.indices[i]].position);
  };
  for (const Primitive& p : mesh.primitives) {
    const bool solid = scene.materials[p.material].alpha_mode != AlphaMode::kMask;
    if (!solid || p.kind != PrimitiveKind::kTriangles) continue;
    for (std::uint32_t i = p.first_index; i + 2 < p.first_index + p.index_count; i += 3) {
      meet(at(i), at(i + 1), at(i + 2), plumb);
    }
  }
}

Plumb plumb_line(const Scene& scene, const std::vector<ObjectDescription>& objects,
                 const glm::dvec3& point) {
  Plumb out;
  for (const Instance& instance : scene.instances) {
    const ObjectDescription& object = objects[instance.object];
    const WorldBox box = world_box(instance, object);
    const bool over = point.x >= box.low.x && point.x <= box.high.x && point.z >= box.low.z &&
                      point.z <= box.high.z;
    if (!over || object.moves()) continue;
    meet(scene.objects[instance.object].mesh, scene, instance.world_from_object, point, out);
  }
  return out;
}

}  // namespace

double walk_eye(const Scene& scene, const std::vector<ObjectDescription>& objects,
                const SceneBounds& bounds) {
  const HomeView& home = scene.home;
  const bool outside =
      !home.fit.empty() || !(glm::length(home.eye - bounds.center) <= bounds.radius);
  if (outside) return 0;
  const Plumb plumb = plumb_line(scene, objects, home.eye);
  const double height = -plumb.below;
  if (!std::isfinite(height) || !(height > 0)) return 0;
  const bool roofed = std::isfinite(plumb.above);
  if (roofed || (height >= kLowestEye && height <= kHighestEye)) return height;
  const bool metres = bounds.radius >= kSmallestPlace && bounds.radius <= kLargestPlace;
  return metres ? kPerson : kPerson * bounds.radius / kUsualPlace;
}

}  // namespace mirage

#include "client/core/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mirage {
namespace {
constexpr double kInstancesPerCell = 16;
// An object of this share of the scene's radius, in a scene of several, is what one stands in.
constexpr double kSurroundingShare = 0.1;
constexpr std::size_t kSurroundedInstances = 16;
constexpr std::uint32_t kMaxSurroundingTriangles = 100'000;
}  // namespace

Result<void> SceneView::accept(const wire::WelcomeT& w) {
  *this = SceneView{};
  welcomed_ = true;
  revision = w.revision;
  name = w.scene;
  renderer = w.renderer;
  triangles = w.triangles;
  expected_objects_ = w.objects;
  expected_instances_ = w.instances;
  Result<Lighting> light = from_wire(*w.lighting);
  if (!light) return light.error();
  lighting = light.take();
  environment = {from_wire(*w.sky_zenith), from_wire(*w.sky_horizon), from_wire(*w.sky_nadir)};
  home = {from_wire(*w.home_eye), from_wire(*w.home_target), w.walk_radius_m, w.walk_speed_mps};
  geometry = w.geometry;
  reference = w.reference;
  return {};
}

Result<void> SceneView::accept(const wire::ObjectPageT& page) {
  if (!welcomed_ || page.first != objects.size() ||
      objects.size() + page.objects.size() > expected_objects_) {
    return make_error(ErrorId::kWireState, "object page out of order");
  }
  for (const std::unique_ptr<wire::ObjectInfoT>& info : page.objects) {
    ObjectDescription o;
    o.center = from_wire(*info->center);
    o.radius = info->radius;
    o.box_min = from_wire(*info->box_min);
    o.box_max = from_wire(*info->box_max);
    o.mean_color = from_wire(*info->mean_color);
    o.needs = info->needs;
    o.triangles = info->triangles;
    o.mesh_bytes = info->mesh_bytes;
    for (const wire::Vec3f& v : info->hull_vertices) o.hull.vertices.push_back(from_wire(v));
    o.hull.indices = info->hull_indices;
    o.hull.parallax = info->hull_parallax;
    objects.push_back(std::move(o));
  }
  if (complete()) finish();
  return {};
}

Result<void> SceneView::accept(const wire::InstancePageT& page) {
  if (!welcomed_ || objects.size() != expected_objects_ || page.first != instances.size() ||
      instances.size() + page.instances.size() > expected_instances_) {
    return make_error(ErrorId::kWireState, "instance page out of order");
  }
  for (const wire::InstanceRecord& record : page.instances) {
    if (record.object() >= objects.size()) {
      return make_error(ErrorId::kWireValue, "instance of an object that is not there");
    }
    InstanceView view;
    view.object = record.object();
    Similarity& m = view.world_from_object;
    m.position = from_wire(record.position());
    m.rotation = glm::normalize(from_wire(record.rotation()));
    m.scale = record.scale();
    const ObjectDescription& object = objects[view.object];
    view.center =
        m.position + glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale});
    view.radius = double{object.radius} * m.scale;
    instances.push_back(view);
  }
  if (complete()) finish();
  return {};
}

bool SceneView::complete() const {
  return welcomed_ && objects.size() == expected_objects_ &&
         instances.size() == expected_instances_;
}

void SceneView::finish() {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const InstanceView& i : instances) {
    low = glm::min(low, i.center - i.radius);
    high = glm::max(high, i.center + i.radius);
  }
  if (!instances.empty()) {
    bounds_center = 0.5 * (low + high);
    bounds_radius = 0;
    for (const InstanceView& i : instances) {
      bounds_radius = std::max(bounds_radius, glm::length(i.center - bounds_center) + i.radius);
    }
  }
  find_surroundings();
  build_grid();
}

void SceneView::find_surroundings() {
  std::vector<std::uint32_t> uses(objects.size(), 0);
  for (const InstanceView& i : instances) ++uses[i.object];
  surrounds_.assign(objects.size(), false);
  if (instances.size() < kSurroundedInstances) return;
  for (const InstanceView& i : instances) {
    surrounds_[i.object] = uses[i.object] == 1 && i.radius > kSurroundingShare * bounds_radius &&
                           objects[i.object].triangles <= kMaxSurroundingTriangles;
  }
}

void SceneView::build_grid() {
  const int n = std::max(
      1, static_cast<int>(std::sqrt(static_cast<double>(instances.size()) / kInstancesPerCell)));
  const auto index = [&](double v, double middle) {
    const double t = bounds_radius > 0 ? (v - middle) / (2 * bounds_radius) + 0.5 : 0.5;
    return std::clamp(static_cast<int>(t * n), 0, n - 1);
  };
  cells_.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), Cell{});
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    const glm::dvec3& c = instances[i].center;
    const int x = index(c.x, bounds_center.x), z = index(c.z, bounds_center.z);
    cells_[static_cast<std::size_t>(z) * static_cast<std::size_t>(n) + static_cast<std::size_t>(x)]
        .instances.push_back(i);
  }
  for (Cell& cell : cells_) {
    for (const std::uint32_t i : cell.instances) {
      cell.center += instances[i].center / static_cast<double>(cell.instances.size());
    }
    for (const std::uint32_t i : cell.instances) {
      cell.radius = std::max(cell.radius,
                             glm::length(instances[i].center - cell.center) + instances[i].radius);
    }
  }
}

void SceneView::for_visible(const Camera& camera, double guard,
                            const std::function<void(std::uint32_t)>& visit) const {
  for (const Cell& cell : cells_) {
    if (cell.instances.empty()) continue;
    if (!camera.may_see(cell.center - camera.pose.eye, cell.radius, guard)) continue;
    for (const std::uint32_t i : cell.instances) {
      const InstanceView& instance = instances[i];
      if (camera.may_see(instance.center - camera.pose.eye, instance.radius, guard)) visit(i);
    }
  }
}

}  // namespace mirage

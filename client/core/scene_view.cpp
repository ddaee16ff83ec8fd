#include "client/core/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mirage {
namespace {
constexpr double kInstancesPerCell = 16;
constexpr int kMaxNesting = 16;
}  // namespace

Result<void> SceneView::accept(const wire::WelcomeT& w) {
  *this = SceneView{};
  welcomed_ = true;
  revision = w.revision;
  name = w.scene;
  renderer = w.renderer;
  triangles = w.triangles;
  expected_images_ = w.images;
  expected_objects_ = w.objects;
  expected_instances_ = w.instances;
  Result<Lighting> light = from_wire(*w.lighting);
  if (!light) return light.error();
  lighting = light.take();
  environment = {from_wire(*w.sky_zenith), from_wire(*w.sky_horizon), from_wire(*w.sky_nadir),
                 w.fog_density};
  home = {from_wire(*w.home_eye), from_wire(*w.home_target), w.walk_radius_m, w.walk_speed_mps};
  geometry = w.geometry;
  reference = w.reference;
  shadows = w.shadows;
  return {};
}

Result<void> SceneView::accept(const wire::ImagePageT& page) {
  if (!welcomed_ || page.first != images.size() ||
      images.size() + page.images.size() > expected_images_) {
    return make_error(ErrorId::kWireState, "image page out of order");
  }
  for (const wire::ImageInfo& info : page.images) {
    ImageDescription image;
    image.width = info.width();
    image.height = info.height();
    image.srgb = info.srgb();
    for (std::size_t c = 0; c < 4; ++c) {
      image.mean[c] = static_cast<std::uint8_t>(info.mean_rgba() >> (8 * c));
    }
    image.alpha_cutoff = info.alpha_cutoff();
    images.push_back(image);
  }
  if (complete()) return finish();
  return {};
}

Result<void> SceneView::accept(const wire::ObjectPageT& page) {
  if (!welcomed_ || images.size() != expected_images_ || page.first != objects.size() ||
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
    for (const wire::LodInfo& lod : info->lods) {
      o.lods.push_back({lod.triangles(), lod.bytes(), lod.error(), lod.spread()});
    }
    for (const wire::Vec3f& v : info->hull_vertices) o.hull.vertices.push_back(from_wire(v));
    o.hull.indices = info->hull_indices;
    o.surrounds = info->surrounds;
    o.group = info->group;
    o.motion = {info->clip_s, info->speed, info->jump, info->wrap_jump};
    o.hull.parallax = info->hull_parallax;
    objects.push_back(std::move(o));
  }
  return complete() ? finish() : Result<void>{};
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
    view.clip_offset_s = record.clip_offset_s();
    view.importance = static_cast<Importance>(record.importance());
    const ObjectDescription& object = objects[view.object];
    view.center =
        m.position + glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale});
    view.radius = double{object.radius} * m.scale;
    view.parent = record.parent();
    instances.push_back(view);
  }
  return complete() ? finish() : Result<void>{};
}

bool SceneView::blends() const {
  return std::any_of(objects.begin(), objects.end(),
                     [](const ObjectDescription& o) { return (o.needs & kNeedBlend) != 0; });
}

bool SceneView::complete() const {
  return welcomed_ && images.size() == expected_images_ && objects.size() == expected_objects_ &&
         instances.size() == expected_instances_;
}

Result<void> SceneView::finish() {
  if (Result<void> linked = link_members(); !linked) return linked;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const InstanceView& i : instances) {
    if (objects[i.object].group) continue;
    low = glm::min(low, i.center - i.radius);
    high = glm::max(high, i.center + i.radius);
  }
  if (!instances.empty()) {
    bounds_center = 0.5 * (low + high);
    bounds_radius = 0;
    for (const InstanceView& i : instances) {
      if (objects[i.object].group) continue;
      bounds_radius = std::max(bounds_radius, glm::length(i.center - bounds_center) + i.radius);
    }
  }
  build_grid();
  return {};
}

Result<void> SceneView::link_members() {
  first_member_.assign(instances.size() + 1, 0);
  for (const InstanceView& i : instances) {
    if (i.parent == InstanceView::kNoParent) continue;
    if (i.parent >= instances.size() || !objects[instances[i.parent].object].group) {
      welcomed_ = false;
      return make_error(ErrorId::kWireValue, "instance in a group that is not there");
    }
    ++first_member_[i.parent + 1];
  }
  for (std::size_t i = 0; i < instances.size(); ++i) first_member_[i + 1] += first_member_[i];
  members_.assign(first_member_.back(), 0);
  std::vector<std::uint32_t> next(first_member_.begin(), first_member_.end() - 1);
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    if (instances[i].parent != InstanceView::kNoParent) members_[next[instances[i].parent]++] = i;
  }
  // Following parents must end: a cycle would be walked for ever.
  for (const InstanceView& i : instances) {
    std::uint32_t at = i.parent;
    int depth = 0;
    while (at != InstanceView::kNoParent && depth++ < kMaxNesting) at = instances[at].parent;
    if (at != InstanceView::kNoParent) {
      welcomed_ = false;
      return make_error(ErrorId::kWireValue, "groups nest too deeply or in a circle");
    }
  }
  return {};
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
    if (instances[i].parent != InstanceView::kNoParent) continue;
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

void SceneView::for_visible_roots(const Camera& camera, double guard,
                                  const std::function<void(std::uint32_t)>& visit) const {
  const Frustum frustum(camera, guard);
  for (const Cell& cell : cells_) {
    if (cell.instances.empty()) continue;
    if (!frustum.may_see(cell.center - camera.pose.eye, cell.radius)) continue;
    for (const std::uint32_t i : cell.instances) {
      const InstanceView& instance = instances[i];
      if (frustum.may_see(instance.center - camera.pose.eye, instance.radius)) visit(i);
    }
  }
}

void SceneView::for_visible(const Camera& camera, double guard,
                            const std::function<void(std::uint32_t)>& visit) const {
  const Frustum frustum(camera, guard);
  const std::function<void(std::uint32_t)> down = [&](std::uint32_t i) {
    if (!objects[instances[i].object].group) return visit(i);
    for (const std::uint32_t member : members(i)) {
      const InstanceView& view = instances[member];
      if (frustum.may_see(view.center - camera.pose.eye, view.radius)) down(member);
    }
  };
  for_visible_roots(camera, guard, down);
}

}  // namespace mirage

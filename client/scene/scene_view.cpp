#include "client/scene/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_set>

#include "protocol/impostor/instance_group.h"
#include "protocol/impostor/motion.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/light_probe_codec.h"

namespace mirage {
namespace {
constexpr double kInstancesPerCell = 16;

InstanceView placed(const Similarity& m, std::uint32_t object, const ObjectDescription& of) {
  InstanceView view;
  view.object = object;
  view.world_from_object = m;
  view.center = m.position + glm::dquat(m.rotation) * (glm::dvec3(of.center) * double{m.scale});
  view.radius = double{of.radius} * m.scale;
  return view;
}

GroupBounds bounds_of(const wire::GroupRecord& record) {
  GroupBounds out;
  out.center = from_wire(record.center());
  out.half = from_wire(record.half());
  for (int c = 0; c < 3; ++c) {
    out.mean_color[c] = static_cast<float>((record.mean_rgb() >> (8 * c)) & 255u) / 255.0f;
  }
  out.needs = record.needs();
  return out;
}
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
  expected_groups_ = w.groups;
  expected_roots_ = w.roots;
  all_instances = w.instances;
  bounds_center = from_wire(*w.bounds_center);
  bounds_radius = w.bounds_radius;
  Result<Lighting> light = from_wire(*w.lighting);
  if (!light) return light.error();
  lighting = light.take();
  environment = {from_wire(*w.sky_zenith), from_wire(*w.sky_horizon),
                 from_wire(*w.sky_nadir),  w.fog_density,
                 ToneCurve::kClip,         {}};
  environment.tone = static_cast<ToneCurve>(w.tone);
  if (w.floor) {
    environment.floor = {from_wire(*w.floor->center), w.floor->half, from_wire(*w.floor->color),
                         w.floor->shadow};
  }
  home = {from_wire(*w.home_eye), from_wire(*w.home_target),
          w.walk_radius_m,        w.walk_speed_mps,
          w.walk_eye_m,           {}};
  for (const wire::Vec3f& point : w.home_fit) home.fit.push_back(from_wire(point));
  note_choices(w);
  geometry = w.geometry;
  reference = w.reference;
  shadows = w.shadows;
  return {};
}

void SceneView::note_choices(const wire::WelcomeT& w) {
  choices = {w.clips, w.variants, {w.clip, w.variant}};
}

Result<void> SceneView::accept(const wire::LightProbePageT& page, const Bytes& payload) {
  if (!welcomed_ || page.id != lighting.probe.id || probe) {
    return make_error(ErrorId::kWireState, "light probe that no welcome named");
  }
  Result<LightProbe> decoded = decode_probe(page, payload);
  if (!decoded) return decoded.error();
  probe = std::make_shared<const LightProbe>(decoded.take());
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
    o.opacity = info->opacity;
    o.name = info->name;
    if (info->faces_axis) o.faces = {from_wire(*info->faces_axis), info->faces_sine};
    o.needs = info->needs;
    o.triangles = info->triangles;
    for (const wire::LodInfo& lod : info->lods) {
      o.lods.push_back({lod.triangles(), lod.bytes(), lod.error(), lod.spread(), lod.shading()});
    }
    for (const wire::Vec3f& v : info->hull_vertices) o.hull.vertices.push_back(from_wire(v));
    o.hull.indices = info->hull_indices;
    o.surrounds = info->surrounds;
    o.motion = {info->clip_s, info->speed, info->jump, info->wrap_jump, info->hidden};
    o.track.clip_s = info->track_clip_s;
    for (const wire::Vec3f& place : info->track) o.track.places.push_back(from_wire(place));
    o.hull.parallax = info->hull_parallax;
    o.cut = info->cut;
    objects.push_back(std::move(o));
  }
  return {};
}

// Takes a page as a whole or not at all. Members come together with their group, so the page either
// knows a parent or rejects it. It follows that groups cannot nest in a circle.
Result<void> SceneView::check_page(const wire::InstancePageT& page) const {
  if (!welcomed_ || images.size() != expected_images_ || objects.size() < expected_objects_) {
    return make_error(ErrorId::kWireState, "instance page out of order");
  }
  std::unordered_set<std::uint32_t> groups, opened;
  const auto known_parent = [&](std::uint32_t id) {
    const std::uint32_t index = index_of(id);
    if (index == InstanceView::kNoParent) return false;
    const ObjectDescription& object = objects[instances[index].object];
    return object.group || object.cut;
  };
  // Parents first: a page may list members of a group that it introduces itself, provided that the
  // group has a valid parent.
  for (const wire::GroupRecord& record : page.groups) {
    const std::size_t number = record.id() - std::size_t{all_instances};
    const bool leaves =
        record.leaves() <= all_instances && record.first_leaf() <= all_instances - record.leaves();
    if (record.id() < all_instances || number >= expected_groups_ || !leaves) {
      return make_error(ErrorId::kWireValue, "group that the scene does not have");
    }
    groups.insert(record.id());
  }
  for (const std::uint32_t id : page.opened) {
    if (!known_parent(id) && groups.count(id) == 0) {
      return make_error(ErrorId::kWireState, "members of a group that is not known yet");
    }
    opened.insert(id);
  }
  const auto may_belong = [&](std::uint32_t parent) {
    return parent == InstanceView::kNoParent || opened.count(parent) != 0;
  };
  for (const wire::GroupRecord& record : page.groups) {
    // A group comes before the groups nested in it: its number is smaller.
    const bool after = record.parent() == InstanceView::kNoParent || record.parent() < record.id();
    if (!may_belong(record.parent()) || !after) {
      return make_error(ErrorId::kWireValue, "group in a group that is not there");
    }
  }
  for (const wire::InstanceRecord& record : page.instances) {
    if (record.object() >= expected_objects_ || record.id() >= all_instances) {
      return make_error(ErrorId::kWireValue, "instance of an object that is not there");
    }
    if (!may_belong(record.parent())) {
      return make_error(ErrorId::kWireValue, "instance in a group that is not there");
    }
  }
  return {};
}

void SceneView::add(InstanceView view, std::uint32_t parent_id) {
  const auto index = static_cast<std::uint32_t>(instances.size());
  if (!index_by_id_.emplace(view.id, index).second) return;  // already known
  // The parent is an id until link_members() makes it an index.
  view.parent = parent_id;
  if (objects[view.object].track.moves()) tracked_.push_back({index, view.world_from_object});
  instances.push_back(view);
}

// Limits how deeply groups nest. Walking the groups recurses, so a peer must not choose the depth.
Result<void> SceneView::note_depths(const wire::InstancePageT& page) {
  std::map<std::uint32_t, std::uint32_t> parents;  // by group; outer ones first
  for (const wire::GroupRecord& record : page.groups) parents[record.id()] = record.parent();
  for (const auto& [id, parent] : parents) {
    const auto above = group_depth_.find(parent);
    const std::uint32_t depth = above == group_depth_.end() ? 1 : above->second + 1;
    if (depth > limits::kMaxGroupDepth) {
      return make_error(ErrorId::kWireLimit, "groups are nested too deeply");
    }
    group_depth_[id] = depth;
  }
  return {};
}

Result<void> SceneView::accept(const wire::InstancePageT& page) {
  if (Result<void> checked = check_page(page); !checked) return checked;
  if (Result<void> nested = note_depths(page); !nested) return nested;
  const bool was_complete = complete();
  const std::size_t first_new = instances.size();
  for (const wire::InstanceRecord& record : page.instances) {
    const Similarity m{from_wire(record.position()), glm::normalize(from_wire(record.rotation())),
                       record.scale()};
    InstanceView view = placed(m, record.object(), objects[record.object()]);
    view.id = record.id();
    view.clip_offset_s = record.clip_offset_s();
    view.importance = static_cast<Importance>(record.importance());
    add(view, record.parent());
  }
  for (const wire::GroupRecord& record : page.groups) {
    if (index_by_id_.count(record.id()) != 0) continue;
    const GroupBounds bounds = bounds_of(record);
    objects.push_back(group_description(bounds));
    // Nothing is nested in a part of an instance, so it is drawn as an object of its own.
    objects.back().part = record.parent() < all_instances;
    objects.back().group = !objects.back().part;
    Similarity m;
    m.position = bounds.center;
    InstanceView view = placed(m, static_cast<std::uint32_t>(objects.size() - 1), objects.back());
    view.id = record.id();
    view.importance = static_cast<Importance>(record.importance());
    view.first_leaf = record.first_leaf();
    view.leaves = record.leaves();
    add(view, record.parent());
  }
  link_members(first_new);
  for (const std::uint32_t id : page.opened) members_of_[index_of(id)].known = true;
  if (complete() && !was_complete) build_grid();
  described_ = described_ || (page.request_id == 0 && page.last);
  return {};
}

// All members of a group come in one page, so they form one run.
void SceneView::link_members(std::size_t first_new) {
  members_of_.resize(instances.size());
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_parent;
  for (std::size_t i = first_new; i < instances.size(); ++i) {
    const auto index = static_cast<std::uint32_t>(i);
    std::uint32_t& parent = instances[i].parent;
    if (parent == InstanceView::kNoParent) {
      roots_.push_back(index);
      continue;
    }
    parent = index_of(parent);
    by_parent[parent].push_back(index);
  }
  for (const auto& [parent, members] : by_parent) {
    Run& run = members_of_[parent];
    if (run.known) continue;  // told twice and differently: the first time counts
    run.first = static_cast<std::uint32_t>(members_.size());
    members_.insert(members_.end(), members.begin(), members.end());
    run.last = static_cast<std::uint32_t>(members_.size());
  }
}

std::uint32_t SceneView::index_of(std::uint32_t id) const {
  const auto at = index_by_id_.find(id);
  return at != index_by_id_.end() ? at->second : InstanceView::kNoParent;
}

std::uint32_t SceneView::object_id(std::uint32_t instance) const {
  const InstanceView& view = instances[instance];
  if (view.id < all_instances) return view.object;
  return static_cast<std::uint32_t>(expected_objects_ + (view.id - all_instances));
}

bool SceneView::blends() const {
  return std::any_of(objects.begin(), objects.end(),
                     [](const ObjectDescription& o) { return (o.needs & kNeedBlend) != 0; });
}

bool SceneView::complete() const {
  const bool lit = lighting.probe.id == 0 || probe;
  return welcomed_ && lit && images.size() == expected_images_ &&
         objects.size() >= expected_objects_ && roots_.size() >= expected_roots_;
}

void SceneView::move_to(double time_s) {
  constexpr double kStep = 1e-3;  // s, between the two places that give a velocity
  for (const Tracked& tracked : tracked_) {
    InstanceView& view = instances[tracked.instance];
    const ObjectDescription& object = objects[view.object];
    const double clip_s = object.track.clip_s;
    const double time = wrap_clip(time_s + view.clip_offset_s, clip_s);
    const double earlier = std::max(0.0, time - kStep), later = std::min(clip_s, time + kStep);
    const InstanceView now =
        placed(on_track(tracked.start, object.track, time), view.object, object);
    view.world_from_object = now.world_from_object;
    view.center = now.center;
    view.velocity = (on_track(tracked.start, object.track, later).position -
                     on_track(tracked.start, object.track, earlier).position) /
                    (later - earlier);
  }
}

void SceneView::build_grid() {
  const int n = std::max(
      1, static_cast<int>(std::sqrt(static_cast<double>(roots_.size()) / kInstancesPerCell)));
  const auto index = [&](double v, double middle) {
    const double t = bounds_radius > 0 ? (v - middle) / (2 * bounds_radius) + 0.5 : 0.5;
    return std::clamp(static_cast<int>(t * n), 0, n - 1);
  };
  cells_.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), Cell{});
  Cell anywhere;  // what goes from cell to cell
  anywhere.center = bounds_center;
  anywhere.radius = std::numeric_limits<double>::max();
  for (const std::uint32_t i : roots_) {
    if (objects[instances[i].object].track.moves()) {
      anywhere.instances.push_back(i);
      continue;
    }
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
  cells_.push_back(std::move(anywhere));
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

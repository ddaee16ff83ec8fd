#pragma once
// Core scene: a small scene as a client gets it from the wire, and tiles for its cache.

#include <functional>
#include <map>
#include <set>
#include <vector>

#include "client/frame/draw_list.h"
#include "client/hold/tile_cache.h"
#include "client/plan/frame_plan.h"
#include "client/plan/mesh_wants.h"
#include "client/plan/selector.h"
#include "client/plan/selector_input.h"
#include "client/plan/tile_need.h"
#include "client/scene/scene_view.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"
#include "wire_generated.h"

namespace mirage::test {

struct Placed {
  glm::dvec3 position{0};
  float scale = 1;
  std::uint32_t object = 0;
  std::uint32_t parent = InstanceView::kNoParent;
  Importance importance = Importance::kNormal;
};

struct SceneOptions {
  std::uint32_t objects = 1;
  float radius = 1;
  bool geometry = false;
  NeedMask needs = 0;
  std::uint32_t triangles = 100;
  std::set<std::uint32_t> surrounds = {};  ///< objects that are scenery around the viewer
};

/// A group, numbered after the instances.
struct PlacedGroup {
  glm::dvec3 center{0};
  float radius = 1;
  std::uint32_t parent = InstanceView::kNoParent;
  std::uint32_t first_leaf = 0, leaves = 0;
};

inline wire::WelcomeT make_welcome(std::size_t instances, std::size_t groups, std::size_t roots,
                                   const SceneOptions& options) {
  wire::WelcomeT welcome;
  welcome.objects = options.objects;
  welcome.instances = static_cast<std::uint32_t>(instances);
  welcome.groups = static_cast<std::uint32_t>(groups);
  welcome.roots = static_cast<std::uint32_t>(roots);
  welcome.lighting = to_wire(Lighting{});
  welcome.sky_zenith = std::make_unique<wire::Vec3f>();
  welcome.sky_horizon = std::make_unique<wire::Vec3f>();
  welcome.sky_nadir = std::make_unique<wire::Vec3f>();
  welcome.home_eye = std::make_unique<wire::Vec3d>();
  welcome.home_target = std::make_unique<wire::Vec3d>(0, 0, -1);
  welcome.bounds_center = std::make_unique<wire::Vec3d>();
  welcome.bounds_radius = 100;
  welcome.geometry = options.geometry;
  return welcome;
}

inline wire::ObjectPageT make_objects(const SceneOptions& options) {
  wire::ObjectPageT objects;
  for (std::uint32_t i = 0; i < options.objects; ++i) {
    auto info = std::make_unique<wire::ObjectInfoT>();
    info->radius = options.radius;
    const float half = 0.577f * info->radius;
    info->center = std::make_unique<wire::Vec3f>();
    info->box_min = std::make_unique<wire::Vec3f>(-half, -half, -half);
    info->box_max = std::make_unique<wire::Vec3f>(half, half, half);
    info->mean_color = std::make_unique<wire::Vec3f>();
    info->needs = options.needs;
    info->triangles = options.triangles;
    info->surrounds = options.surrounds.count(i) != 0;
    objects.objects.push_back(std::move(info));
  }
  return objects;
}

inline wire::InstanceRecord instance_record(const Placed& p, std::uint32_t id) {
  return {to_wire(p.position),
          wire::Quat(1, 0, 0, 0),
          p.scale,
          id,
          p.object,
          p.parent,
          0.0f,
          static_cast<std::uint8_t>(p.importance)};
}

/// Returns the record of a group. `needs` are those of its members.
inline wire::GroupRecord group_record(const PlacedGroup& g, std::uint32_t id, NeedMask needs) {
  const float half = 0.57735f * g.radius;
  return {to_wire(g.center),
          wire::Vec3f(half, half, half),
          0u,
          needs,
          id,
          g.parent,
          g.first_leaf,
          g.leaves,
          std::uint8_t{1}};
}

/// Returns a scene. Instances have the indices of `placed`; groups follow.
inline SceneView make_scene(const std::vector<Placed>& placed, const SceneOptions& options = {},
                            const std::vector<PlacedGroup>& groups = {}) {
  wire::InstancePageT page;
  page.last = true;
  std::size_t roots = 0;
  const auto own = static_cast<std::uint32_t>(placed.size());
  for (const Placed& p : placed) {
    roots += p.parent == InstanceView::kNoParent ? 1 : 0;
    page.instances.push_back(instance_record(p, static_cast<std::uint32_t>(page.instances.size())));
  }
  for (const PlacedGroup& g : groups) {
    roots += g.parent == InstanceView::kNoParent ? 1 : 0;
    const auto id = own + static_cast<std::uint32_t>(page.groups.size());
    page.groups.push_back(group_record(g, id, options.needs));
    page.opened.push_back(id);
  }
  SceneView scene;
  const wire::WelcomeT welcome = make_welcome(placed.size(), groups.size(), roots, options);
  const bool taken = scene.accept(welcome).ok() && scene.accept(make_objects(options)).ok() &&
                     scene.accept(page).ok();
  return taken ? scene : SceneView{};
}

/// Returns a tile as a server would measure it on a ball: content over the whole window, half the
/// radius deep on either side. Hull and cuboid are useless, so that the flat choice is the quad.
inline Tile make_tile(const Capture& capture) {
  Tile tile;
  tile.edge = capture.edge;
  tile.crop = {1, 1, capture.edge - 2, capture.edge - 2};
  const auto distance = static_cast<float>(capture.distance);
  const auto radius = static_cast<float>(capture.radius);
  tile.measure.plane_depth = distance;
  tile.measure.depth_min = distance - 0.5f * radius;
  tile.measure.depth_max = distance + 0.5f * radius;
  tile.measure.dz_quad = 0.5f * radius;
  tile.measure.dz_hull = tile.measure.dz_cuboid = 10 * radius;
  return tile;
}

inline Capture capture_for(const TileNeed& need, double radius) {
  return Capture(need.cell, need.distance, radius, tile_edge(need.size_class));
}

/// Scene, cache and selector, driven frame by frame.
struct SelectorWorld {
  explicit SelectorWorld(SceneView view) : scene(std::move(view)) {
    cache.reset(scene, scene.lighting);
    selector.reset(scene);
    mesh_ready.assign(scene.objects.size(), false);
  }
  SelectorInput input() const {
    SelectorInput in;
    in.scene = &scene;
    in.cache = &cache;
    in.mesh_ready = &mesh_ready;
    in.plan = &any_time;
    in.camera = in.predicted = camera;
    in.frame = frame;
    in.now_us = now_us;
    return in;
  }
  void look(const glm::dvec3& eye, const glm::dvec3& target) { camera.pose = look_at(eye, target); }
  /// Adds the tile that a server would send for the present view of `instance`.
  TileRecordPtr add_tile(
      std::uint32_t instance,
      const std::function<void(TileMeasure&)>& change = [](TileMeasure&) {}) {
    const ObjectDescription& object = scene.objects[scene.instances[instance].object];
    const TileNeed need =
        need_for_view(view_geometry(camera, scene.instances[instance], object), ViewPlan{});
    const Capture capture = capture_for(need, object.radius);
    Tile tile = make_tile(capture);
    change(tile.measure);
    return cache.insert(instance, scene, capture, std::move(tile), frame, now_us);
  }
  /// Selects as a session does, and marks what is drawn in the cache.
  DrawList select(const SelectorInput& in) { return select(in, any_time); }
  DrawList select(const SelectorInput& in, FramePlan& plan) {
    DrawList list = only_select(in, plan);
    cache.mark_drawn(list.tiles(), in.frame);
    return list;
  }

  /// Selects without a mark in the cache.
  DrawList only_select(const SelectorInput& in) { return only_select(in, any_time); }
  DrawList only_select(const SelectorInput& in, FramePlan& plan) {
    considered.clear();
    selector.consider(in, considered);
    return selector.draw(in, plan.decide({in.camera}, considered, in.now_us).data());
  }

  SceneView scene;
  TileCache cache{2048, 4};
  Selector selector;
  FramePlan any_time{0, 1};
  std::vector<Alternatives> considered;  ///< by the last select()
  std::vector<bool> mesh_ready;
  Camera camera;
  std::uint64_t frame = 10;
  std::int64_t now_us = 0;
};

/// Returns a ball of radius 1 in the middle, seen from 5 m.
inline SelectorWorld one_ball(bool geometry = false) {
  SceneOptions options;
  options.geometry = geometry;
  SelectorWorld world(make_scene({{{0, 0, 0}}}, options));
  world.look({0, 0, 5}, {0, 0, 0});
  return world;
}

}  // namespace mirage::test

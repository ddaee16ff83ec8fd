#pragma once
// A small scene as a client gets it from the wire, and tiles to put into its cache.

#include <map>
#include <set>
#include <vector>

#include "client/core/selector.h"

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
  std::set<std::uint32_t> surrounds = {};      ///< objects that are scenery around the viewer
  std::map<std::uint32_t, float> groups = {};  ///< objects that are groups, with their radii
};

inline SceneView make_scene(const std::vector<Placed>& placed, const SceneOptions& options = {}) {
  wire::WelcomeT welcome;
  welcome.objects = options.objects;
  welcome.instances = static_cast<std::uint32_t>(placed.size());
  welcome.lighting = to_wire(Lighting{});
  welcome.sky_zenith = std::make_unique<wire::Vec3f>();
  welcome.sky_horizon = std::make_unique<wire::Vec3f>();
  welcome.sky_nadir = std::make_unique<wire::Vec3f>();
  welcome.home_eye = std::make_unique<wire::Vec3d>();
  welcome.home_target = std::make_unique<wire::Vec3d>(0, 0, -1);
  welcome.geometry = options.geometry;
  wire::ObjectPageT objects;
  for (std::uint32_t i = 0; i < options.objects; ++i) {
    auto info = std::make_unique<wire::ObjectInfoT>();
    const auto group = options.groups.find(i);
    info->group = group != options.groups.end();
    info->radius = info->group ? group->second : options.radius;
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
  wire::InstancePageT instances;
  for (const Placed& p : placed) {
    instances.instances.emplace_back(to_wire(p.position), wire::Quat(1, 0, 0, 0), p.scale, p.object,
                                     p.parent, 0.0f, static_cast<std::uint8_t>(p.importance));
  }
  SceneView scene;
  const bool taken =
      scene.accept(welcome).ok() && scene.accept(objects).ok() && scene.accept(instances).ok();
  return taken ? scene : SceneView{};
}

/// A tile as a server would measure it on a ball: content over the whole window, half the radius
/// deep on either side; hull and cuboid useless, so that the flat choice is the quad.
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
    in.camera = in.predicted = camera;
    in.frame = frame;
    in.now_us = now_us;
    return in;
  }
  void look(const glm::dvec3& eye, const glm::dvec3& target) { camera.pose = look_at(eye, target); }
  /// The tile a server would send for the present view of `instance`.
  TileRecordPtr add_tile(std::uint32_t instance) {
    const ObjectDescription& object = scene.objects[scene.instances[instance].object];
    const TileNeed need =
        need_for_view(view_geometry(camera, scene.instances[instance], object), ViewPlan{});
    const Capture capture = capture_for(need, object.radius);
    return cache.insert(instance, scene, capture, make_tile(capture), frame, now_us);
  }

  SceneView scene;
  TileCache cache{2048, 4};
  Selector selector;
  std::vector<bool> mesh_ready;
  Camera camera;
  std::uint64_t frame = 10;
  std::int64_t now_us = 0;
};

}  // namespace mirage::test

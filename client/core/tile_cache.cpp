#include "client/core/tile_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/lighting_state.h"
#include "protocol/stable_math.h"

namespace mirage {
namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxTilesPerGroup = 8;
constexpr std::size_t kMaxEmptyViews = 64;
constexpr double kEmptyAngle = 0.02;  // radians around an empty view that count as empty, at least
constexpr int kGutter = 1;  // texels of nothing around a tile, so that filtering never bleeds
}  // namespace

DrawnDepth TileRecord::drawn_depth(DrawMethod method, const ObjectDescription& description) const {
  const double r = capture.radius, dc = capture.distance, cone = tangent_length(dc, r);
  // Between texel centres a surface may lie two texels of slope off the stored depth; what is
  // steeper belongs to the disocclusions.
  const double slope = 2.0 * capture.texel_width(1.0) * dc * dc / measure.depth_min;
  DrawnDepth out;
  out.surface_min = measure.depth_min;
  out.surface_max = measure.depth_max;
  switch (method) {
    case DrawMethod::kCuboid:
      out.dz = measure.dz_cuboid + slope;
      out.q = box_extent(description);
      return out;
    case DrawMethod::kHull:
      // Without a hull there is nothing to draw on: no bound.
      out.dz = measure.dz_hull + slope;
      out.q = description.hull.indices.empty() ? kInfinity : hull_extent(description);
      return out;
    case DrawMethod::kDepth: {
      // Interpolated depth stays within half a code of the stored one (relief.glsl).
      const double step = depth_code.inverse_quantum();
      out.dz = 2.0 * step * dc * dc + slope;
      const double off = out.dz / (dc * dc);
      out.surface_min = std::max(1.0 / (1.0 / measure.depth_min + off), 0.0);
      out.surface_max = 1.0 / std::max(1.0 / measure.depth_max - off, 1e-12 / dc);
      out.drawn_min = out.surface_min;
      out.drawn_max = out.surface_max;
      out.q = r + (out.surface_max - measure.depth_max) * dc / cone;
      return out;
    }
    case DrawMethod::kWarp: {
      // Surface and drawn point lie on one capture ray, each within the measured range.
      const double low = measure.depth_min, high = measure.depth_max;
      out.dz = dc * dc * (1.0 / low - 1.0 / high) * (1 + 1e-5);
      out.drawn_min = low;
      out.drawn_max = high;
      out.q = std::max(std::hypot(low - dc, low * r / cone), std::hypot(high - dc, high * r / cone));
      return out;
    }
    case DrawMethod::kQuad:
    case DrawMethod::kMesh:
      break;
  }
  const double z = measure.plane_depth;
  out.dz = measure.dz_quad;
  out.q = std::hypot(z - dc, z * r / cone);
  out.drawn_min = out.drawn_max = z;
  return out;
}

double TileRecord::bound_px(DrawMethod method, const ObjectDescription& description,
                            const ViewGeometry& view) const {
  const CaptureGeometry geometry = capture.geometry(crop);
  return position_bound_px(view, geometry, drawn_depth(method, description)) +
         footprint_px(texel_size_px(view, geometry, capture.edge));
}

bool TileGroup::empty_from(const glm::dvec3& eye) const {
  const glm::dvec3 axis = safe_normalize(eye);
  return std::any_of(empty_views.begin(), empty_views.end(), [&](const EmptyView& view) {
    return glm::dot(axis, view.axis) >= view.cos_angle;
  });
}

TileCache::TileCache(int atlas_edge, int atlas_layers) : allocator_(atlas_edge, atlas_layers) {}

void TileCache::reset(const SceneView& scene, const Lighting& lighting) {
  for (TileGroup& group : groups_) {
    while (!group.tiles.empty()) forget(group, 0);
  }
  groups_.clear();
  group_index_.clear();
  instance_group_.clear();
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    instance_group_.push_back(group_of(scene, i, lighting));
  }
  former_group_ = instance_group_;
}

void TileCache::relight(const SceneView& scene, const Lighting& lighting) {
  for (std::uint32_t i = 0; i < instance_group_.size(); ++i) {
    if (!groups_[instance_group_[i]].tiles.empty()) former_group_[i] = instance_group_[i];
    instance_group_[i] = group_of(scene, i, lighting);
  }
}

std::uint32_t TileCache::group_of(const SceneView& scene, std::uint32_t instance,
                                  const Lighting& lighting) {
  const InstanceView& view = scene.instances[instance];
  const ObjectDescription& object = scene.objects[view.object];
  std::uint64_t key = view.object;
  if (object.needs & kNeedLighting) {
    const std::uint64_t light =
        object_lighting(lighting, view.world_from_object, object.center, object.radius).hash();
    key ^= light * 0x9e3779b97f4a7c15ull;
  }
  const auto [at, is_new] = group_index_.emplace(key, static_cast<std::uint32_t>(groups_.size()));
  if (is_new) groups_.emplace_back();
  return at->second;
}

const TileGroup* TileCache::group_to_draw(std::uint32_t instance) const {
  const TileGroup& own = groups_[instance_group_[instance]];
  if (own.known()) return &own;
  return &groups_[former_group_[instance]];
}

bool TileCache::lit_now(std::uint32_t instance) const {
  const TileGroup& own = groups_[instance_group_[instance]];
  return own.known() || former_group_[instance] == instance_group_[instance];
}

TileRecordPtr TileCache::insert(std::uint32_t instance, const SceneView& scene,
                                const Capture& capture, Tile tile, std::uint64_t frame,
                                std::int64_t now_us) {
  TileGroup& group = groups_[instance_group_[instance]];
  if (tile.crop.area() == 0) {
    const double angle = std::max(view_cell_angle(capture.view_level), kEmptyAngle);
    if (group.empty_views.size() >= kMaxEmptyViews)
      group.empty_views.erase(group.empty_views.begin());
    group.empty_views.push_back({-capture.basis.forward, std::cos(angle)});
    return nullptr;
  }
  AtlasSlot slot;
  const int w = static_cast<int>(tile.crop.w) + 2 * kGutter;
  const int h = static_cast<int>(tile.crop.h) + 2 * kGutter;
  if (!make_room(w, h, frame, slot)) return nullptr;
  auto record = std::make_shared<TileRecord>();
  record->object = scene.instances[instance].object;
  record->serial = next_serial_++;
  record->capture = capture;
  record->crop = tile.crop;
  record->measure = tile.measure;
  record->depth_code = DepthCode(capture.radius, capture.distance);
  record->slot = slot;
  record->depth = std::move(tile.depth);
  record->received_us = now_us;
  record->last_drawn = frame;
  group.tiles.push_back(record);
  ++resident_;
  trim(group, frame);
  return record;
}

bool TileCache::make_room(int w, int h, std::uint64_t frame, AtlasSlot& slot) {
  for (;;) {
    if (const std::optional<AtlasSlot> found = allocator_.allocate(w, h)) {
      slot = *found;
      return true;
    }
    if (w > allocator_.edge() || h > allocator_.edge() || !evict_oldest(frame)) return false;
  }
}

bool TileCache::evict_oldest(std::uint64_t frame) {
  TileGroup* oldest_group = nullptr;
  std::size_t oldest_index = 0;
  std::uint64_t oldest = frame;
  for (TileGroup& group : groups_) {
    for (std::size_t i = 0; i < group.tiles.size(); ++i) {
      if (group.tiles[i]->last_drawn + 1 >= oldest) continue;
      oldest = group.tiles[i]->last_drawn + 1;
      oldest_group = &group;
      oldest_index = i;
    }
  }
  if (!oldest_group) return false;
  forget(*oldest_group, oldest_index);
  return true;
}

void TileCache::forget(TileGroup& group, std::size_t index) {
  allocator_.release(group.tiles[index]->slot);
  group.tiles.erase(group.tiles.begin() + static_cast<std::ptrdiff_t>(index));
  --resident_;
}

void TileCache::trim(TileGroup& group, std::uint64_t frame) {
  while (group.tiles.size() > kMaxTilesPerGroup) {
    const auto oldest = std::min_element(group.tiles.begin(), group.tiles.end() - 1,
                                         [](const TileRecordPtr& a, const TileRecordPtr& b) {
                                           return a->last_drawn < b->last_drawn;
                                         });
    if ((*oldest)->last_drawn + 1 >= frame) return;  // shared by many instances, all in view
    forget(group, static_cast<std::size_t>(oldest - group.tiles.begin()));
  }
}

}  // namespace mirage

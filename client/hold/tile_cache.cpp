#include "client/hold/tile_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "protocol/impostor/object_proxy.h"

namespace mirage {
namespace {
constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxTilesPerGroup = 8;
constexpr std::size_t kMaxMovingTilesPerGroup = 512;  // a clip that loops is drawn from them again
constexpr std::size_t kMaxEmptyViews = 64;
constexpr double kEmptyAngle = 0.02;  // radians around an empty view that count as empty, at least
constexpr std::size_t kReservedShare = 8;  // share 1/8 of a full atlas, kept for first images
constexpr int kGutter = 1;  // empty texels around a tile, so that filtering never bleeds

// Keys of relit tiles. They differ from those of LightHistory, which are small or well mixed.
std::uint64_t relit_key(std::uint32_t object) { return ~std::uint64_t{object}; }

// True if two captures of one object give the same picture.
bool same_picture(const Capture& a, const Capture& b) {
  return a.basis.forward == b.basis.forward && a.distance == b.distance && a.edge == b.edge;
}
}  // namespace

void TileRecord::seal(const ObjectDescription& description) {
  whole_ = capture.geometry();
  content_ = capture.geometry(crop);
  for (std::size_t i = 0; i < drawn_.size(); ++i) {
    drawn_[i] = drawn_depth(static_cast<DrawMethod>(i), description);
  }
}

DrawnDepth TileRecord::drawn_depth(DrawMethod method, const ObjectDescription& description) const {
  // The captured level lies within its error of the surface, and is drawn as if it were the
  // surface.
  DrawnDepth drawn = drawn_depth_of_lod(method, description);
  const double error = measure.lod_error, dc = capture.distance;
  if (error <= 0) return drawn;
  drawn.surface_min = std::max(drawn.surface_min - error, 1e-9 * dc);
  drawn.surface_max += error;
  drawn.dz += error * dc * dc / (drawn.surface_min * drawn.surface_min);
  drawn.q += error;
  return drawn;
}

DrawnDepth TileRecord::drawn_depth_of_lod(DrawMethod method,
                                          const ObjectDescription& description) const {
  const double r = capture.radius, dc = capture.distance, cone = tangent_length(dc, r);
  // Between texel centres a surface may lie two texels of slope off the stored depth. Steeper
  // surfaces belong to the disocclusions.
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
      // An object without a hull has nothing to draw on, so the bound is infinite.
      out.dz = measure.dz_hull + slope;
      out.q = description.hull.indices.empty() ? kEndless : hull_extent(description);
      return out;
    case DrawMethod::kDepth: {
      // Interpolated depth stays within half a code of the stored one (relief.glsl).
      const double step = depth_code.inverse_quantum();
      out.dz = 2.0 * step * dc * dc + slope + measure.dz_behind;
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
      out.q =
          std::max(std::hypot(low - dc, low * r / cone), std::hypot(high - dc, high * r / cone));
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

double TileRecord::motion_px(const ObjectDescription& description, const ViewGeometry& view) const {
  const MotionProfile& motion = description.motion;
  if (!motion.moving()) return 0;
  return motion_bound_px(view, motion.travel(phase_time(phase, motion.clip_s), view.clip_time_s));
}

double TileRecord::bound_px(DrawMethod method, const ObjectDescription& description,
                            const ViewGeometry& view) const {
  // An eye behind the object sees nothing that was captured: all of it may be off by the object's
  // size.
  const bool behind = glm::dot(view.eye, content_.axis) < 0;
  const double unseen = behind ? lod_error_px(view, 2 * view.radius) : 0.0;
  return unseen + position_bound_px(view, content_, drawn_[static_cast<std::size_t>(method)]) +
         motion_px(description, view) + footprint_px(texel_size_px(view, content_, capture.edge)) +
         lod_error_px(view, measure.lod_error);
}

bool TileGroup::empty_from(const glm::dvec3& eye) const {
  const glm::dvec3 axis = safe_normalize(eye);
  return std::any_of(empty_views.begin(), empty_views.end(), [&](const EmptyView& view) {
    return glm::dot(axis, view.axis) >= view.cos_angle;
  });
}

TileCache::TileCache(int atlas_edge, int atlas_layers) : allocator_(atlas_edge, atlas_layers) {}

void TileCache::reset(const SceneView& scene, const Lighting& lighting) {
  for (auto& [key, group] : groups_) {
    while (!group.tiles.empty()) forget(group, 0);
  }
  groups_.clear();
  owned_.clear();
  oldest_last_.clear();
  listed_at_ = UINT64_MAX;
  refused_edge_ = UINT32_MAX;
  lights_.reset(scene, lighting);
}

const TileGroup* TileCache::find(std::uint64_t key) const {
  const auto at = groups_.find(key);
  return at != groups_.end() && at->second.known() ? &at->second : nullptr;
}

TileCache::LitGroup TileCache::lit_group(std::uint32_t instance) const {
  static const TileGroup kNothing;
  const bool relit = wants_relit(instance);
  const auto bare = [&]() -> const TileGroup* {
    const bool can = lights_.can_relight(instance);
    return can ? find(relit_key(lights_.object_of(instance))) : nullptr;
  };
  if (relit) {
    if (const TileGroup* wanted = bare()) return {wanted, true, nullptr};
  }
  const TileGroup* own = find(lights_.key(instance, lights_.current()));
  if (own) return {own, !relit, nullptr};
  if (!relit) {
    if (const TileGroup* other = bare()) return {other, false, nullptr};
  }
  const std::vector<LightHistory::State>& states = lights_.states();
  for (std::size_t i = states.size() - 1; i-- > 0 && lights_.lit(instance);) {
    const TileGroup* former = find(lights_.key(instance, states[i]));
    if (former) return {former, false, &states[i]};
  }
  return {&kNothing, true, nullptr};
}

void TileCache::relight(const Lighting& lighting, std::int64_t now_us) {
  lights_.set(lighting, now_us);
  // A state that returns brings its groups back with it.
  const std::uint64_t turn = lights_.current().turn;
  for (const std::uint64_t key : lights_.current().keys) {
    const auto at = groups_.find(key);
    if (at != groups_.end()) at->second.turn = std::max(at->second.turn, turn);
  }
  drop_past_groups();
}

// Drops groups of lightings that are no longer kept. Under a light that never returns, groups would
// pile up, most of them without tiles.
void TileCache::drop_past_groups() {
  if (lights_.states().size() < limits::kMaxLightingStatesPerClient) return;
  const std::uint64_t oldest = lights_.states().front().turn;
  for (auto at = groups_.begin(); at != groups_.end();) {
    TileGroup& group = at->second;
    if (group.turn >= oldest) {
      ++at;
      continue;
    }
    while (!group.tiles.empty()) forget(group, 0);
    at = groups_.erase(at);
  }
}

TileRecordPtr TileCache::insert(std::uint32_t instance, const SceneView& scene,
                                const Capture& capture, Tile tile, std::uint64_t frame,
                                std::int64_t now_us, std::uint32_t light, Phase phase) {
  const LightHistory::State* state = light == 0 ? &lights_.current() : lights_.find(light);
  if (!state) return nullptr;
  const bool relit = tile.relit();
  TileGroup& group =
      groups_[relit ? relit_key(lights_.object_of(instance)) : lights_.key(instance, *state)];
  group.turn = relit || !lights_.lit(instance) ? UINT64_MAX : std::max(group.turn, state->turn);
  if (tile.crop.area() == 0 && phase != kStaticPhase) return nullptr;  // another pose may show
  if (tile.crop.area() == 0) {
    const double angle = std::max(view_cell_angle(capture.view_level), kEmptyAngle);
    if (group.empty_views.size() >= kMaxEmptyViews)
      group.empty_views.erase(group.empty_views.begin());
    group.empty_views.push_back({-capture.basis.forward, std::cos(angle)});
    return nullptr;
  }
  auto record = std::make_shared<TileRecord>();
  const int w = static_cast<int>(tile.crop.w) + 2 * kGutter;
  const int h = static_cast<int>(tile.crop.h) + 2 * kGutter;
  if (!make_room(w, h, frame, record->slot)) {
    refused_edge_ = capture.edge;
    refused_at_texels_ = texels_in_view(frame);
    return nullptr;
  }
  // A layered tile without room for its layers, or with nothing in the second, serves as a lit
  // tile.
  if (std::any_of(tile.behind_depth.begin(), tile.behind_depth.end(), [](auto c) { return c; }) &&
      make_room_for_layers(w, h, frame, *record)) {
    record->behind_depth = std::move(tile.behind_depth);
  }
  record->object = scene.instances[instance].object;
  record->serial = next_serial_++;
  record->capture = capture;
  record->crop = tile.crop;
  record->measure = tile.measure;
  record->depth_code = DepthCode(capture.radius, capture.distance);
  record->depth = std::move(tile.depth);
  record->phase = phase;
  record->relit = relit;
  record->received_us = now_us;
  record->last_drawn = frame;
  record->seal(scene.objects[record->object]);
  group.tiles.push_back(record);
  owned_[record->serial] = record;
  trim(group, frame);
  return record;
}

void TileCache::mark_drawn(const std::vector<TileRecordPtr>& tiles, std::uint64_t frame) {
  for (const TileRecordPtr& tile : tiles) {
    const auto at = owned_.find(tile->serial);
    if (at == owned_.end()) continue;
    at->second->last_drawn = frame;
    at->second->shown = true;
  }
}

bool TileCache::holds(std::uint32_t instance, const Capture& capture, bool relit, Phase phase,
                      std::uint32_t light) const {
  const LightHistory::State* state = light == 0 ? &lights_.current() : lights_.find(light);
  if (!state) return false;
  const TileGroup* group =
      find(relit ? relit_key(lights_.object_of(instance)) : lights_.key(instance, *state));
  if (!group) return false;
  return std::any_of(group->tiles.begin(), group->tiles.end(), [&](const TileRecordPtr& tile) {
    return tile->relit == relit && tile->phase == phase && same_picture(tile->capture, capture);
  });
}

std::size_t TileCache::texels_in_view(std::uint64_t frame) const {
  std::size_t texels = 0;
  for (const auto& [key, group] : groups_) {
    for (const TileRecordPtr& tile : group.tiles) {
      if (tile->last_drawn + 1 < frame) continue;
      const std::size_t slots = tile->layered() ? 3 : 1;
      texels += slots * allocator_.footprint(tile->slot.w, tile->slot.h);
    }
  }
  return texels;
}

std::size_t TileCache::footprint(std::uint32_t edge) const {
  const int side = static_cast<int>(edge) + 2 * kGutter;
  return allocator_.footprint(side, side);
}

TileCache::Room TileCache::room(std::uint64_t frame) const {
  const auto edge = static_cast<std::size_t>(allocator_.edge());
  const std::size_t all = edge * edge * static_cast<std::size_t>(allocator_.layers());
  Room out;
  // A tile as large as a layer fits: its guard makes up for the gutter.
  out.edge = static_cast<std::uint32_t>(edge) + 1;
  if (refused_edge_ == UINT32_MAX && allocator_.used_texels() < all / 2) return out;
  const std::size_t in_view = texels_in_view(frame);
  out.texels = all > in_view ? all - in_view : 0;
  out.reserved = all / kReservedShare;
  // A tile of an edge that found no place before will find none now, unless much has left the view.
  if (4 * in_view >= 3 * refused_at_texels_) out.edge = std::min(out.edge, refused_edge_);
  return out;
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

// Evicts from a list that is made at most once a frame. Tiles drawn since then are younger than
// everything left in the list.
bool TileCache::evict_oldest(std::uint64_t frame) {
  for (;;) {
    while (!oldest_last_.empty() && oldest_last_.back().last_drawn + 1 < frame) {
      const Aged aged = oldest_last_.back();
      oldest_last_.pop_back();
      const auto group = groups_.find(aged.group);
      if (group == groups_.end()) continue;
      std::vector<TileRecordPtr>& tiles = group->second.tiles;
      const auto at = std::find_if(tiles.begin(), tiles.end(), [&](const TileRecordPtr& tile) {
        return tile->serial == aged.serial;
      });
      if (at == tiles.end() || (*at)->last_drawn != aged.last_drawn) continue;
      forget(group->second, static_cast<std::size_t>(at - tiles.begin()));
      return true;
    }
    if (listed_at_ == frame) return false;
    list_by_age();
    listed_at_ = frame;
  }
}

void TileCache::list_by_age() {
  oldest_last_.clear();
  for (const auto& [key, group] : groups_) {
    for (const TileRecordPtr& tile : group.tiles) {
      oldest_last_.push_back({tile->last_drawn, tile->serial, key});
    }
  }
  // Equally old tiles: the one that arrived earlier goes first, whatever the order of the groups.
  std::sort(oldest_last_.begin(), oldest_last_.end(), [](const Aged& a, const Aged& b) {
    return std::tie(a.last_drawn, a.serial) > std::tie(b.last_drawn, b.serial);
  });
}

bool TileCache::make_room_for_layers(int w, int h, std::uint64_t frame, TileRecord& record) {
  if (!make_room(w, h, frame, record.front_slot)) return false;
  if (make_room(w, h, frame, record.behind_slot)) return true;
  allocator_.release(record.front_slot);
  return false;
}

void TileCache::forget(TileGroup& group, std::size_t index) {
  const TileRecord& tile = *group.tiles[index];
  allocator_.release(tile.slot);
  if (tile.layered()) {
    allocator_.release(tile.front_slot);
    allocator_.release(tile.behind_slot);
  }
  owned_.erase(tile.serial);
  group.tiles.erase(group.tiles.begin() + static_cast<std::ptrdiff_t>(index));
}

void TileCache::trim(TileGroup& group, std::uint64_t frame) {
  const bool moves = group.tiles.back()->phase != kStaticPhase;
  while (group.tiles.size() > (moves ? kMaxMovingTilesPerGroup : kMaxTilesPerGroup)) {
    const auto oldest = std::min_element(group.tiles.begin(), group.tiles.end() - 1,
                                         [](const TileRecordPtr& a, const TileRecordPtr& b) {
                                           return a->last_drawn < b->last_drawn;
                                         });
    if ((*oldest)->last_drawn + 1 >= frame) return;  // many instances in view share them
    forget(group, static_cast<std::size_t>(oldest - group.tiles.begin()));
  }
}

}  // namespace mirage

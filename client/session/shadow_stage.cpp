#include "client/session/shadow_stage.h"

#include <algorithm>
#include <cmath>

#include "client/frame/draw_list.h"
#include "client/hold/light_history.h"
#include "client/hold/mesh_cache.h"
#include "client/hold/tile_cache.h"
#include "client/plan/selector_input.h"
#include "client/price/ask_gain.h"
#include "client/scene/scene_view.h"
#include "protocol/base/stable_math.h"
#include "protocol/impostor/object_proxy.h"

namespace mirage {
namespace {

constexpr std::int64_t kWalkEveryUs = 500'000;  // least time between two searches for casters
constexpr std::int64_t kSunRestsUs = 400'000;   // time at rest before shadow tiles are asked for
constexpr int kShadowViewLevel = 7;             // cells of 1.9 degrees at most
constexpr double kShadowAngle = 0.1;            // radians from which another view is worth a tile
constexpr int kHalfEdge = 2;                    // size classes below the colour tile's
constexpr double kCoarsestTexelPx = 2.7;        // twice the size asked for
constexpr double kShadowShare = 0.5;            // share of its contrast: colour goes first
// Capture distance: the light is as good as parallel.
constexpr double kCasterRadii = 64;
constexpr double kCasterAngle = 0.35;        // radians beyond which a silhouette differs
constexpr double kCasterTexels = 2;          // texels of the map in one texel of a caster tile
constexpr double kCasterTexelPx = 1.5;       // least screen size of that texel
constexpr int kMaxCasterClass = 8;           // 256 texels
constexpr double kFinestCasterAngle = 0.02;  // radians; finer cells would not show
// Share of the radius, about the plane it is drawn on.
constexpr double kCasterDepth = 0.5;
constexpr double kSmallestCasterPx = 4;  // radius on the screen
constexpr double kGroupCasterRadii = 6;  // a group casts as one from this far
constexpr double kMeshCasterRadii = 3;   // nearer than this, a mesh casts itself

glm::dvec3 to_object(const InstanceView& view, const glm::dvec3& direction) {
  return glm::conjugate(glm::dquat(view.world_from_object.rotation)) * direction;
}

bool same(const CasterList& a, const CasterList& b) {
  const auto same_tile = [](const DrawnCaster& x, const DrawnCaster& y) {
    return x.instance == y.instance && x.tile == y.tile;
  };
  const auto same_mesh = [](const DrawnMesh& x, const DrawnMesh& y) {
    return x.instance == y.instance && x.lod == y.lod;
  };
  return a.frame.forward == b.frame.forward && a.assets == b.assets &&
         std::equal(a.tiles.begin(), a.tiles.end(), b.tiles.begin(), b.tiles.end(), same_tile) &&
         std::equal(a.meshes.begin(), a.meshes.end(), b.meshes.begin(), b.meshes.end(), same_mesh);
}

Lighting without_sun(const Lighting& lighting) {
  Lighting out = lighting;
  if (const Light* sun = sun_of(lighting))
    out.lights.erase(out.lights.begin() + (sun - lighting.lights.data()));
  return out;
}

}  // namespace

struct ShadowStage::CasterWalk {
  const SelectorInput& in;
  CasterList& list;
  std::vector<TileNeed>& needs;
  /// Index into `needs`, by object and view cell.
  std::map<std::tuple<std::uint32_t, std::uint8_t, std::uint16_t, std::uint16_t>, std::size_t>
      asked;
};

void ShadowStage::reset() {
  cache_.reset();
  casters_.reset();
  caster_needs_.clear();
  walked_us_ = light_since_us_ = INT64_MIN / 2;
}

ShadowRecordPtr ShadowStage::insert(const TileNeed& need, std::uint32_t object,
                                    const Capture& capture, const TileCrop& crop,
                                    std::uint64_t frame) {
  if (need.channels == kCasterTile) {
    // The need is answered; the next walk tells whether more is needed.
    const auto same = [&](const TileNeed& n) { return n.instance == need.instance; };
    caster_needs_.erase(std::remove_if(caster_needs_.begin(), caster_needs_.end(), same),
                        caster_needs_.end());
    return cache_.add_caster(object, capture, crop, frame);
  }
  return cache_.add_shadow(need.instance, need.light, capture, crop, frame);
}

// Adds every caster that may matter: its mesh if that is near and resident, otherwise a tile as the
// sun sees it. A far group casts as one.
void ShadowStage::walk_casters(CasterWalk& w, std::uint32_t instance) const {
  const SelectorInput& in = w.in;
  const InstanceView& view_of = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view_of.object];
  const double distance = glm::length(view_of.center - in.camera.pose.eye);
  const bool opens = object.group && in.scene->opened(instance);
  if (opens && distance < kGroupCasterRadii * view_of.radius) {
    for (const std::uint32_t member : in.scene->members(instance)) walk_casters(w, member);
    return;
  }
  if (!object.casts()) return;
  const double size_px = in.camera.focal_px() * view_of.radius / std::max(distance, 1e-9);
  if (size_px < kSmallestCasterPx) return;
  const bool near = object.surrounds || distance < kMeshCasterRadii * view_of.radius;
  if (near && !object.group && (*in.mesh_ready)[view_of.object]) {
    w.list.meshes.push_back({instance, 0, 1});
    return;
  }
  if (object.surrounds && in.scene->geometry) return;  // its mesh is on the way
  const glm::dvec3 sunward = to_object(view_of, -w.list.frame.forward);
  double angle = 0;
  const ShadowRecordPtr held = cache_.caster(view_of.object, sunward, angle);
  if (held && angle < kCasterAngle && held->crop.area() > 0) {
    held->last_used = in.frame;
    w.list.tiles.push_back({instance, held});
  }
  // Texels as fine as the map can show, and no finer than the screen does.
  const double nearest = std::max(distance - view_of.radius, 0.0);
  const double texel_m = std::max(kCasterTexels * w.list.frame.texel_m(),
                                  kCasterTexelPx * nearest / in.camera.focal_px());
  const double allowed = texel_m / (kCasterDepth * view_of.radius);
  TileNeed need;
  need.cell = *view_cell_from_direction(
      sunward, view_level_for_angle(std::clamp(allowed, kFinestCasterAngle, kCasterAngle)));
  need.size_class = static_cast<std::uint8_t>(
      std::min(size_class_for(2 * view_of.radius / texel_m), kMaxCasterClass));
  const bool sharp = held && 2 * held->capture.edge >= tile_edge(need.size_class);
  if (sharp && angle <= view_cell_angle(need.cell.level)) return;
  const auto [known, first] = w.asked.emplace(
      std::tuple(view_of.object, need.cell.level, need.cell.x, need.cell.y), w.needs.size());
  if (!first) {  // another instance: one tile for both, sharp enough for the nearer
    std::uint8_t& size_class = w.needs[known->second].size_class;
    size_class = std::max(size_class, need.size_class);
    return;
  }
  need.instance = instance;
  need.distance = *distance_bucket_from_radii(kCasterRadii, 0);
  need.channels = kCasterTile;
  need.light = in.cache->light();
  need.error_px = std::min(size_px, 1e4);
  need.life_s = kLongestLife;
  const double area = disc_px(in.camera, size_px);
  need.gain =
      (held ? 0.1 : kShadowShare) * ask_gain(area, tile_wrongs(area, false, size_px, 1, 1),
                                             tile_wrongs(area, false, 0, 1, 1), kLongestLife);
  w.needs.push_back(need);
}

void ShadowStage::shade(const SelectorInput& in, const Lighting& lighting, MeshCache& meshes,
                        DrawList& list) {
  const Light* sun = sun_of(lighting);
  if (!sun) {
    casters_.reset();
    caster_needs_.clear();
    return;
  }
  const SunFrame frame(sun->direction, in.scene->bounds_center, in.scene->bounds_radius,
                       kShadowMapEdge);
  const bool turned = !casters_ || casters_->frame.forward != frame.forward;
  if (turned || in.now_us - walked_us_ >= kWalkEveryUs) {
    walked_us_ = in.now_us;
    CasterList next;
    next.frame = frame;
    next.assets = assets_;
    caster_needs_.clear();
    CasterWalk walk{in, next, caster_needs_, {}};
    for (const std::uint32_t root : in.scene->roots()) walk_casters(walk, root);
    meshes.choose(*in.scene, in.camera, in.tau_px, in.frame, in.now_us, next.meshes);
    if (!casters_ || !same(*casters_, next)) {
      casters_ = std::make_shared<const CasterList>(std::move(next));
    }
  }
  list.casters = casters_;
  for (DrawnImpostor& drawn : list.impostors) {
    const InstanceView& view_of = in.scene->instances[drawn.instance];
    const glm::dvec3 eye = to_object(view_of, in.camera.pose.eye - view_of.center);
    double angle = 0;
    const ShadowRecordPtr tile = cache_.shadow(drawn.instance, in.cache->light(), eye, angle);
    if (!tile || tile->crop.area() == 0) continue;
    tile->last_used = in.frame;
    drawn.shadow = tile;
  }
}

void ShadowStage::add_shadow_need(const SelectorInput& in, const Lighting& dark,
                                  const DrawnImpostor& drawn, std::vector<TileNeed>& needs) const {
  const InstanceView& view_of = in.scene->instances[drawn.instance];
  const ObjectDescription& object = in.scene->objects[view_of.object];
  if (!(object.needs & kNeedLighting) || object.moves()) return;
  const ViewGeometry view = view_geometry(in.predicted, view_of, object);
  const double size = radius_px(view);
  const double contrast_px = light_error_px(in.cache->lights().current().lighting, dark, view_of,
                                            object, std::min(size, 1e4));
  if (contrast_px <= in.tau_px) return;
  double angle = 0;
  const ShadowRecordPtr held = cache_.shadow(drawn.instance, in.cache->light(), view.eye, angle);
  TileNeed need = need_for_view(view, ViewPlan{});
  need.size_class = static_cast<std::uint8_t>(std::max(need.size_class - kHalfEdge, 0));
  if (held && angle < kShadowAngle) {
    // A large class is limited, so the tile that comes may be coarser than wanted.
    const bool finest = held->capture.edge >= tile_edge(need.size_class);
    const double texel_px = texel_size_px(view, held->capture.geometry(), held->capture.edge);
    if (held->crop.area() == 0 || finest || texel_px < kCoarsestTexelPx) return;
  }
  need.instance = drawn.instance;
  need.cell = *view_cell_from_direction(view.eye, kShadowViewLevel);
  need.distance = *distance_bucket_from_radii(glm::length(view.eye) / view.radius, 1);
  need.channels = kShadowTile;
  need.light = in.cache->light();
  need.error_px = contrast_px;
  const double worth = held ? std::min(angle / kShadowAngle, 2.0) * 0.25 : 1.0;
  need.life_s = kLongestLife;
  const double area = disc_px(in.predicted, size);
  need.gain = worth * kShadowShare *
              ask_gain(area, tile_wrongs(area, false, contrast_px, 1, 1),
                       tile_wrongs(area, false, 0, 1, 1), kLongestLife);
  needs.push_back(need);
}

void ShadowStage::add_needs(const SelectorInput& in, const Lighting& lighting, const DrawList& list,
                            std::vector<TileNeed>& needs) const {
  if (!casters_) return;
  needs.insert(needs.end(), caster_needs_.begin(), caster_needs_.end());
  if (in.now_us - light_since_us_ >= kSunRestsUs) {
    const Lighting dark = without_sun(lighting);
    std::uint32_t last = InstanceView::kNoParent;
    for (const DrawnImpostor& drawn : list.impostors) {
      if (drawn.instance != last) add_shadow_need(in, dark, drawn, needs);
      last = drawn.instance;
    }
  }
}

}  // namespace mirage

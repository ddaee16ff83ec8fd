#include "client/plan/selector_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/hold/mesh_cache.h"
#include "client/hold/tile_cache.h"
#include "client/plan/frame_plan.h"
#include "client/plan/importance.h"
#include "client/plan/tile_fit.h"
#include "client/plan/tile_need.h"
#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/need_mask.h"

namespace mirage {
namespace {

// Nearer than this, in radii, no picture can stand for the object: the eye is in its sphere.
constexpr double kInsideRadii = 1 + 1e-6;
// Geometry is asked for from this many times the distance at which it is drawn.
constexpr double kMeshPrefetch = 1.3;
// Nearer than this a tile lasts for one step only, so geometry is asked for whatever its bytes.
constexpr double kNearRadii = 2;
constexpr std::uint32_t kTileBytes = 1500;  // of a middling tile on the wire
// Error of an asked tile towards the end of its life, over tau: at least and at most.
constexpr double kAgedTilePx = 2, kOldestTilePx = 8;
constexpr double kReplyS = 0.25;  // from the wish for a tile to the tile, on a usual link
// Radii, a radian.
constexpr double kUnseen = 0.25;
constexpr double kTileShare = 0.6;  // of the captured square that its content fills

// True for geometry that takes fewer bytes than any one tile. It is sent once, and right from
// everywhere.
bool cheaper_than_tiles(const ObjectDescription& object) {
  constexpr NeedMask kImages = kNeedBaseColorMap | kNeedMetalRoughMap | kNeedNormalMap |
                               kNeedOcclusionMap | kNeedEmissiveMap;
  return !object.lods.empty() && object.lods[0].bytes <= kTileBytes && !(object.needs & kImages);
}

// True if geometry of the object is right from everywhere and asked for whatever tiles cost.
bool comes_first(const SelectorInput& in, const ObjectDescription& object) {
  return cheaper_than_tiles(object) || (in.geometry_first && !object.lods.empty());
}

// Returns the seconds for which a tile asked for now would serve.
double tile_life_s(const SelectorInput& in, const Camera& camera, std::uint32_t instance,
                   double tau_px) {
  const InstanceView& view_of = in.scene->instances[instance];
  ViewPlan plan;
  plan.tau_px = tau_px;
  plan.velocity = glm::dvec3(glm::length(in.velocity) / view_of.world_from_object.scale, 0, 0);
  return expected_life_s(view_geometry(camera, view_of, in.scene->objects[view_of.object]), plan);
}

}  // namespace

bool outside(const ViewGeometry& view) {
  return glm::length(view.eye) > kInsideRadii * view.radius && is_finite(view.eye);
}

double allowed_px(const SelectorInput& in, const Camera& camera, const InstanceView& view) {
  // Attention matters only when tau has been steered up.
  const bool steered = in.tau_px > in.target_px;
  const double looked_at = steered ? attention(camera, view) : 1;
  return allowed_error_px(in.tau_px, in.target_px, looked_at, view.importance);
}

bool group_wanted(const SelectorInput& in, const InstanceView& view_of, const ViewGeometry& view,
                  double tau_px, double slack) {
  if (in.method.eight_views) return false;
  if (glm::length(view.eye) * slack < kGroupRadii * view.radius) return false;
  ViewPlan plan;
  plan.tau_px = tau_px;
  plan.depth_share = kTypicalGap / hole_tolerance(tau_px, radius_px(view));
  const double speed = std::max(glm::length(in.velocity), kWalkingMps);
  plan.velocity = glm::dvec3(speed / view_of.world_from_object.scale, 0, 0);
  return expected_life_s(view, plan) * slack >= kGroupLifeS;
}

double light_change_px(const SelectorInput& in, const TileCache::LitGroup& lit,
                       std::uint32_t instance, double radius_px) {
  if (!lit.then) return 0;
  const InstanceView& view = in.scene->instances[instance];
  return light_error_px(lit.then->lighting, in.cache->lights().current().lighting, view,
                        in.scene->objects[view.object], radius_px);
}

double swap_radii(const SelectorInput& in, const ObjectDescription& object) {
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  if (!in.method.automatic && in.method.method == DrawMethod::kMesh) return kEverywhere;
  if (object.surrounds) return kEverywhere;
  if (in.method.automatic && in.mesh_radii > 0 && comes_first(in, object)) return kEverywhere;
  return in.method.automatic ? in.mesh_radii : std::min(in.mesh_radii, kSwapRadii);
}

bool comes_as_mesh(const SelectorInput& in, const ObjectDescription& object, double radii) {
  if (!in.scene->geometry) return false;
  const double swap = swap_radii(in, object);
  if (!in.method.automatic) return radii < kMeshPrefetch * swap;
  return object.surrounds || (in.mesh_radii > 0 && comes_first(in, object)) ||
         radii < std::min(swap, kNearRadii);
}

bool mesh_pays(const SelectorInput& in, const Camera& camera, std::uint32_t instance,
               double tile_px) {
  const InstanceView& view = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view.object];
  if (!in.method.automatic || object.surrounds || object.lods.empty()) return true;
  const glm::dvec3 center = view.center - camera.pose.eye;
  if (glm::length(center) < limits::kMinCaptureRadii * view.radius) return true;
  Alternatives thing;
  thing.area_px = shown_area_px(camera, center, view.radius);
  thing.alpha_tested = object.needs & kNeedAlphaMask;
  thing.flat = Alternatives::Tile{tile_px, std::max(1.0, in.tau_px), kTileShare};
  const double density = px_per_unit(*in.scene, camera, instance);
  const LodInfo& lod = object.lods[lod_for_view(object.lods, density, in.mesh_tau_px)];
  thing.levels.push_back({0, lod.triangles, lod_excess(lod, density, 1)});
  return in.plan->mesh_pays(thing);
}

double aged_tile_px(double tau_px, double life_s) {
  return tau_px * std::clamp(1 + kReplyS / life_s, kAgedTilePx, kOldestTilePx);
}

bool too_dear(const SelectorInput& in, const Camera& camera, std::uint32_t instance,
              double tau_px) {
  if (!in.plan->limited()) return false;
  const double life_s = tile_life_s(in, camera, instance, tau_px);
  return !mesh_pays(in, camera, instance, aged_tile_px(tau_px, life_s));
}

double turned_since(const TileRecord& tile, const ViewGeometry& view) {
  const double cosine = glm::dot(glm::normalize(view.eye), tile.whole().axis);
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

double unseen_px(const TileRecord& tile, const ViewGeometry& view) {
  const double size = radius_px(view);
  return std::isfinite(size) ? kUnseen * turned_since(tile, view) * size : 0;
}

}  // namespace mirage

#include "client/core/selector_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/core/importance.h"
#include "protocol/limits.h"
#include "protocol/need_mask.h"
#include "protocol/stable_math.h"

namespace mirage {
namespace {

// Nearer, in radii, no picture of the object can stand for it: the eye is in its sphere.
constexpr double kInsideRadii = 1 + 1e-6;
constexpr std::uint32_t kTileBytes = 1500;  // of a middling tile, as it travels
// Beyond so many radii a tile may stand in for geometry that is there, when it is drawn for less:
// a triangle costs as much as so many pixels of a quad, or more.
constexpr double kStandInRadii = 3;
constexpr double kPixelsPerTriangle = 16;
// A tile that is asked for: its error over tau in the middle of its life, and its share of its
// frame.
constexpr double kGoodTilePx = 0.5, kGoodTileShare = 0.6;

// Sent once, such geometry costs less than any one tile, and is right from everywhere.
bool cheaper_than_tiles(const ObjectDescription& object) {
  constexpr NeedMask kImages = kNeedBaseColorMap | kNeedMetalRoughMap | kNeedNormalMap |
                               kNeedOcclusionMap | kNeedEmissiveMap;
  return !object.lods.empty() && object.lods[0].bytes <= kTileBytes && !(object.needs & kImages);
}

}  // namespace

bool outside(const ViewGeometry& view) {
  return glm::length(view.eye) > kInsideRadii * view.radius && is_finite(view.eye);
}

double allowed_px(const SelectorInput& in, const Camera& camera, const InstanceView& view) {
  // Where the viewer looks matters to a tau that was steered up only.
  const bool steered = in.tau_px > in.target_px;
  const double looked_at = steered ? attention(camera, in.cursor_px, view) : 1;
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
  const bool cheap = in.method.automatic && in.mesh_radii > 0 && cheaper_than_tiles(object);
  return cheap ? kEverywhere : in.mesh_radii;
}

bool comes_as_mesh(const SelectorInput& in, const ObjectDescription& object, double radii) {
  return in.scene->geometry && radii < swap_radii(in, object);
}

bool too_dear(const SelectorInput& in, const Camera& camera, std::uint32_t instance,
              double tau_px) {
  const InstanceView& view = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view.object];
  if (!in.plan || !in.method.automatic || object.surrounds || object.lods.empty()) return false;
  const glm::dvec3 center = view.center - camera.pose.eye;
  if (glm::length(center) < limits::kMinCaptureRadii * view.radius) return false;
  Alternatives thing;
  thing.area_px = shown_area_px(camera, center, view.radius);
  thing.alpha_tested = object.needs & kNeedAlphaMask;
  thing.flat = Alternatives::Tile{kGoodTilePx * tau_px, std::max(1.0, tau_px), kGoodTileShare};
  const double density = px_per_unit(*in.scene, camera, instance);
  const LodInfo& lod = object.lods[lod_for_view(object.lods, density, tau_px)];
  thing.triangles = lod.triangles;
  thing.mesh_px = lod_excess(lod, density, 1);
  return !in.plan->mesh_pays(thing, true);
}

bool may_stand_in(const SelectorInput& in, const ObjectDescription& object,
                  const ViewGeometry& view, double tau_px) {
  const double distance = glm::length(view.eye), size = radius_px(view);
  if (!in.method.automatic || object.group || object.motion.moving()) return false;
  if (std::isinf(swap_radii(in, object)) || distance < kStandInRadii * view.radius) return false;
  const double px_per_unit = view.focal_px / (distance - view.radius);
  const std::size_t lod = lod_for_view(object.lods, px_per_unit, tau_px);
  return lod < object.lods.size() &&
         object.lods[lod].triangles * kPixelsPerTriangle > 3.14159 * size * size;
}

}  // namespace mirage

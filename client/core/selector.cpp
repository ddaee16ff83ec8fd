#include "client/core/selector.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/limits.h"
#include "protocol/stable_math.h"

namespace mirage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMinRadiusPx = 0.5;        // smaller objects are neither drawn nor asked for
constexpr double kViewGuard = 0.0873;       // 5 degrees around the predicted view
constexpr std::int64_t kFadeUs = 120'000;
constexpr double kTexelsPerPixel = 1.5;     // measured: worth more than any filter
constexpr int kMaxAskedSizeClass = 12;      // 1024 texels
constexpr double kMeshRadii = limits::kMinCaptureRadii;
constexpr double kMeshPrefetchRadii = 1.6;
// A newer tile replaces the one shown only when it is clearly better, or the old one too bad.
constexpr double kSwitchRatio = 0.6;

struct Choice {
  TileRecordPtr tile;
  DrawMethod method = DrawMethod::kQuad;
  double bound = kInfinity;
};

// Cheapest first (DESIGN section 7): a quad costs a fraction of marching depth.
constexpr DrawMethod kByCost[] = {DrawMethod::kQuad, DrawMethod::kHull, DrawMethod::kDepth};

Choice best_method(const TileRecordPtr& tile, const ObjectDescription& object,
                   const ViewGeometry& view, const MethodChoice& choice, double tau) {
  if (!choice.automatic) {
    return {tile, choice.method, tile->bound_px(choice.method, object, view)};
  }
  Choice best;
  for (const DrawMethod method : kByCost) {
    const double bound = tile->bound_px(method, object, view);
    if (!best.tile || bound < best.bound) best = {tile, method, bound};
    if (!is_stale(bound, tau)) break;
  }
  return best;
}

Choice best_tile(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                 const MethodChoice& method, double tau) {
  Choice best;
  for (const TileRecordPtr& tile : group.tiles) {
    const Choice choice = best_method(tile, object, view, method, tau);
    // Inside the swap distance every bound is infinite: the newest tile is the best guess.
    const bool better = choice.bound < best.bound ||
                        (choice.bound == best.bound && best.tile && tile->serial > best.tile->serial);
    if (!best.tile || better) best = choice;
  }
  return best;
}

bool drawn_as_mesh(const SelectorInput& in, const InstanceView& instance, double distance) {
  if (!(*in.mesh_ready)[instance.object]) return false;
  return in.method.method == DrawMethod::kMesh && !in.method.automatic
             ? true
             : distance < kMeshRadii * instance.radius;
}

}  // namespace

ViewGeometry view_geometry(const Camera& camera, const InstanceView& instance,
                           const ObjectDescription& object) {
  const double scale = instance.world_from_object.scale;
  const glm::dvec3 to_eye = camera.pose.eye - instance.center;
  ViewGeometry view;
  view.focal_px = camera.focal_px();
  view.radius = object.radius;
  view.eye = glm::conjugate(glm::dquat(instance.world_from_object.rotation)) * to_eye / scale;
  view.center_depth = -glm::dot(to_eye, camera.forward()) / scale;
  return view;
}

double radius_px(const ViewGeometry& view) {
  const double d = glm::length(view.eye);
  return d > view.radius ? view.focal_px * view.radius / tangent_length(d, view.radius) : kInfinity;
}

TileNeed need_for_view(const ViewGeometry& view, double tau_px) {
  const double r = view.radius;
  const double d = std::max(glm::length(view.eye), limits::kMinCaptureRadii * r * 1.001);
  // Depth as if the object were looked at: turning the head must not change the key.
  const double slack = (d - r) * (d - r);
  const double dz = 0.5 * r;  // half the visible depth of a ball; measured values are smaller
  const double allowed = 0.25 * tau_px * slack / (view.focal_px * dz);  // of the baseline term
  const double theta = std::asin(std::min(1.0, allowed / d));
  const double cone = r / tangent_length(d, r);
  const double along = std::min(allowed / cone, 0.5 * d);
  TileNeed need;
  need.cell = *view_cell_from_direction(view.eye, view_level_for_angle(theta));
  int level = 0;
  // Half a bucket of 1/2^level octaves is the farthest a distance can be from its middle.
  while (level < limits::kMaxDistanceLevel && d * std::expm1(0.34657 / (1 << level)) > along) {
    ++level;
  }
  need.distance = *distance_bucket_from_radii(d / r, level);
  const double dc = radii_from_distance_bucket(need.distance) * r;
  const double half = r / tangent_length(dc, r) * dc;
  const double texels = kTexelsPerPixel * 2.0 * view.focal_px * half / d;
  need.size_class =
      static_cast<std::uint8_t>(std::min(size_class_for(texels * 0.95), kMaxAskedSizeClass));
  return need;
}

void Selector::reset(const SceneView& scene) {
  shown_.assign(scene.instances.size(), Shown{});
}

void Selector::draw_instance(const SelectorInput& in, std::uint32_t instance, DrawList& out) {
  const InstanceView& view_of = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view_of.object];
  const ViewGeometry view = view_geometry(in.camera, view_of, object);
  if (object.radius <= 0 || radius_px(view) < kMinRadiusPx) return;
  ++out.visible;
  const double distance = glm::length(view_of.center - in.camera.pose.eye);
  if (drawn_as_mesh(in, view_of, distance)) {
    out.meshes.push_back(instance);
    shown_[instance] = Shown{};
    return;
  }
  const TileGroup& group = *in.cache->group_to_draw(instance);
  if (group.tiles.empty()) {
    if (group.empty_seen) return;
    out.placeholders.push_back({instance, distance});
    ++out.over_tau;
    return;
  }
  Choice best = best_tile(group, object, view, in.method, in.tau_px);
  Shown& shown = shown_[instance];
  const bool still_held = std::find(group.tiles.begin(), group.tiles.end(), shown.tile) != group.tiles.end();
  if (still_held && shown.tile != best.tile) {
    const Choice present = best_method(shown.tile, object, view, in.method, in.tau_px);
    if (!is_stale(present.bound, in.tau_px) && present.bound * kSwitchRatio < best.bound) {
      best = present;
    }
  }
  if (shown.tile != best.tile) {
    shown.former = still_held ? shown.tile : nullptr;
    shown.tile = best.tile;
    shown.since_us = in.now_us;
  }
  double fade = 1;
  if (shown.former) {
    fade = std::min(1.0, static_cast<double>(in.now_us - shown.since_us) / kFadeUs);
    if (fade >= 1) {
      shown.former.reset();
    } else {
      const Choice under = best_method(shown.former, object, view, in.method, in.tau_px);
      shown.former->last_drawn = in.frame;
      out.impostors.push_back({instance, under.tile, under.method, under.bound, distance, 1.0f});
    }
  }
  best.tile->last_drawn = in.frame;
  best.tile->shown = true;
  out.impostors.push_back(
      {instance, best.tile, best.method, best.bound, distance, static_cast<float>(fade)});
  if (is_stale(best.bound, in.tau_px)) ++out.over_tau;
}

DrawList Selector::select(const SelectorInput& in) {
  DrawList out;
  in.scene->for_visible(in.camera, 0,
                        [&](std::uint32_t instance) { draw_instance(in, instance, out); });
  // Back to front, so that blending is right; equal distances keep the order of instances.
  std::stable_sort(out.impostors.begin(), out.impostors.end(),
                   [](const DrawnImpostor& a, const DrawnImpostor& b) {
                     return a.distance > b.distance;
                   });
  return out;
}

std::vector<TileNeed> Selector::needs(const SelectorInput& in) const {
  std::vector<TileNeed> out;
  if (!in.method.automatic && in.method.method == DrawMethod::kMesh) return out;
  in.scene->for_visible(in.predicted, kViewGuard, [&](std::uint32_t instance) {
    const InstanceView& view_of = in.scene->instances[instance];
    const ObjectDescription& object = in.scene->objects[view_of.object];
    ViewGeometry view = view_geometry(in.predicted, view_of, object);
    const double size = radius_px(view);
    if (object.radius <= 0 || size < kMinRadiusPx) return;
    const double distance = glm::length(view.eye) / view.radius;
    if ((*in.mesh_ready)[view_of.object] && distance < kMeshRadii) return;
    const TileGroup& group = *in.cache->group_to_draw(instance);
    double bound = kInfinity;
    if (!group.tiles.empty()) {
      // At the edge of the view the eye depth falls; ask as if the object were looked at.
      view.center_depth = glm::length(view.eye);
      bound = best_tile(group, object, view, in.method, in.tau_px).bound;
    } else if (group.empty_seen) {
      return;
    }
    if (!is_stale(bound, in.tau_px) && in.cache->lit_now(instance)) return;
    // Inside the swap distance a tile is no use but as a stopgap: one, until geometry comes.
    if (distance < limits::kMinCaptureRadii && !group.tiles.empty()) return;
    TileNeed need = need_for_view(view, in.tau_px);
    need.instance = instance;
    need.error_px = std::isfinite(bound) ? std::min(bound, 2 * size) : 2 * std::min(size, 1e4);
    out.push_back(need);
  });
  std::stable_sort(out.begin(), out.end(), [](const TileNeed& a, const TileNeed& b) {
    return a.error_px > b.error_px;
  });
  return out;
}

std::vector<std::uint32_t> Selector::mesh_needs(const SelectorInput& in) const {
  std::vector<std::uint32_t> out;
  const bool all = !in.method.automatic && in.method.method == DrawMethod::kMesh;
  in.scene->for_visible(in.predicted, kViewGuard, [&](std::uint32_t instance) {
    const InstanceView& view_of = in.scene->instances[instance];
    if ((*in.mesh_ready)[view_of.object]) return;
    const double distance = glm::length(view_of.center - in.predicted.pose.eye);
    if (all || distance < kMeshPrefetchRadii * view_of.radius) out.push_back(view_of.object);
  });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace mirage

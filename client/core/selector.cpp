#include "client/core/selector.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/limits.h"
#include "protocol/stable_math.h"

namespace mirage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMinRadiusPx = 0.5;   // smaller objects are neither drawn nor asked for
constexpr double kViewGuard = 0.0873;  // 5 degrees around the predicted view
constexpr std::int64_t kFadeUs = 120'000;
constexpr double kTexelsPerPixel = 1.5;  // measured: worth more than any filter
constexpr int kMaxAskedSizeClass = 12;   // 1024 texels
constexpr int kCoarseClasses = 4;        // steps of sqrt 2
constexpr double kMeshPrefetch = 1.3;    // times the swap distance
constexpr double kWorthMarching = 0.7;   // of the flat bound
constexpr double kLongestLife = 2;       // s, a tile is not credited with more
// A newer tile replaces the one shown only when it is clearly better, or the old one too bad.
constexpr double kSwitchRatio = 0.6;

struct Choice {
  TileRecordPtr tile;
  DrawMethod method = DrawMethod::kQuad;
  double bound = kInfinity;
};

// Cheapest first (DESIGN section 7): marching depth costs ten times what a flat proxy does.
constexpr DrawMethod kFlat[] = {DrawMethod::kQuad, DrawMethod::kHull};
constexpr DrawMethod kDeep[] = {DrawMethod::kDepth};

template <std::size_t N>
Choice best_method(const TileRecordPtr& tile, const ObjectDescription& object,
                   const ViewGeometry& view, const DrawMethod (&methods)[N], double tau) {
  Choice best;
  for (const DrawMethod method : methods) {
    const double bound = tile->bound_px(method, object, view);
    if (!best.tile || bound < best.bound) best = {tile, method, bound};
    if (!is_stale(bound, tau)) break;
  }
  return best;
}

// Inside the swap distance every bound is infinite: the newest tile is the best guess.
void keep_better(Choice& best, const Choice& choice) {
  const bool better = choice.bound < best.bound || (choice.bound == best.bound && best.tile &&
                                                    choice.tile->serial > best.tile->serial);
  if (!best.tile || better) best = choice;
}

template <std::size_t N>
Choice best_tile(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                 const DrawMethod (&methods)[N], double tau) {
  Choice best;
  for (const TileRecordPtr& tile : group.tiles) {
    keep_better(best, best_method(tile, object, view, methods, tau));
  }
  return best;
}

Choice best_with(const TileGroup& group, const ObjectDescription& object, const ViewGeometry& view,
                 DrawMethod method, double tau) {
  const DrawMethod one[] = {method};
  return best_tile(group, object, view, one, tau);
}

// The best that can be drawn at all, whatever it costs.
Choice best_of_all(const TileGroup& group, const ObjectDescription& object,
                   const ViewGeometry& view, const SelectorInput& in) {
  if (!in.method.automatic) return best_with(group, object, view, in.method.method, in.tau_px);
  Choice best = best_tile(group, object, view, kFlat, in.tau_px);
  if (is_stale(best.bound, in.tau_px)) {
    keep_better(best, best_tile(group, object, view, kDeep, in.tau_px));
  }
  return best;
}

bool drawn_as_mesh(const SelectorInput& in, const InstanceView& instance, double distance) {
  if (!(*in.mesh_ready)[instance.object]) return false;
  return in.method.method == DrawMethod::kMesh && !in.method.automatic
             ? true
             : in.scene->surrounds(instance.object) || distance < in.mesh_radii * instance.radius;
}

// How long a tile captured now stays within tau as a quad, the eye moving at `speed` (object units
// per second): near tiles age fast, and would eat the link if error alone ranked them.
double expected_life_s(const ViewGeometry& view, double tau_px, double speed) {
  const double slack = std::max(glm::length(view.eye) - view.radius, 1e-3 * view.radius);
  const double px_per_s = view.focal_px * 0.5 * view.radius * speed / (slack * slack);
  return std::clamp(tau_px / std::max(px_per_s, 1e-9), 0.02, kLongestLife);
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
  view.forward =
      glm::conjugate(glm::dquat(instance.world_from_object.rotation)) * camera.forward();
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

void Selector::reset(const SceneView& scene) { shown_.assign(scene.instances.size(), Shown{}); }

struct Selector::Candidate {
  std::uint32_t instance = 0;
  const TileGroup* group = nullptr;
  const ObjectDescription* object = nullptr;
  ViewGeometry view;
  double distance = 0;
  double area_px = 0;
  Choice flat;
  Choice deep;
  bool march = false;
};

void Selector::consider(const SelectorInput& in, std::uint32_t instance, DrawList& out,
                        std::vector<Candidate>& candidates) {
  const InstanceView& view_of = in.scene->instances[instance];
  Candidate c;
  c.instance = instance;
  c.object = &in.scene->objects[view_of.object];
  c.view = view_geometry(in.camera, view_of, *c.object);
  const double size = radius_px(c.view);
  if (c.object->radius <= 0 || size < kMinRadiusPx) return;
  ++out.visible;
  c.distance = glm::length(view_of.center - in.camera.pose.eye);
  if (drawn_as_mesh(in, view_of, c.distance)) {
    out.meshes.push_back(instance);
    shown_[instance] = Shown{};
    return;
  }
  c.group = in.cache->group_to_draw(instance);
  if (c.group->empty_from(c.view.eye)) return;
  if (c.group->tiles.empty()) {
    out.placeholders.push_back({instance, c.distance});
    ++out.over_tau;
    return;
  }
  if (in.method.automatic) {
    c.flat = best_tile(*c.group, *c.object, c.view, kFlat, in.tau_px);
    if (is_stale(c.flat.bound, in.tau_px)) {
      c.deep = best_tile(*c.group, *c.object, c.view, kDeep, in.tau_px);
    }
  } else {
    c.flat = best_with(*c.group, *c.object, c.view, in.method.method, in.tau_px);
  }
  const double screen = static_cast<double>(in.camera.width) * in.camera.height;
  c.area_px = std::min(3.14159 * size * size, screen);
  candidates.push_back(c);
}

void Selector::draw_candidate(const SelectorInput& in, const Candidate& c, DrawList& out) {
  Choice best = c.march ? c.deep : c.flat;
  Shown& shown = shown_[c.instance];
  const std::vector<TileRecordPtr>& held = c.group->tiles;
  const bool still_held = std::find(held.begin(), held.end(), shown.tile) != held.end();
  const auto choice_for = [&](const TileRecordPtr& tile) {
    const DrawMethod one[] = {best.method};
    return best_method(tile, *c.object, c.view, one, in.tau_px);
  };
  if (still_held && shown.tile != best.tile) {
    const Choice present = choice_for(shown.tile);
    if (!is_stale(present.bound, in.tau_px) && present.bound * kSwitchRatio < best.bound) {
      best = present;
    }
  }
  if (shown.tile != best.tile) {
    shown.former = still_held ? shown.tile : nullptr;
    shown.tile = best.tile;
    shown.since_us = in.now_us;
  }
  // A former tile that left the cache meanwhile has no texels of its own any more.
  if (std::find(held.begin(), held.end(), shown.former) == held.end()) shown.former.reset();
  double fade = 1;
  if (shown.former) {
    fade = std::min(1.0, static_cast<double>(in.now_us - shown.since_us) / kFadeUs);
    if (fade >= 1) {
      shown.former.reset();
    } else {
      const Choice under = choice_for(shown.former);
      shown.former->last_drawn = in.frame;
      out.impostors.push_back(
          {c.instance, under.tile, under.method, under.bound, c.distance, 1.0f});
    }
  }
  best.tile->last_drawn = in.frame;
  best.tile->shown = true;
  out.impostors.push_back(
      {c.instance, best.tile, best.method, best.bound, c.distance, static_cast<float>(fade)});
  if (is_stale(best.bound, in.tau_px)) ++out.over_tau;
}

DrawList Selector::select(const SelectorInput& in) {
  DrawList out;
  std::vector<Candidate> candidates;
  in.scene->for_visible(in.camera, 0,
                        [&](std::uint32_t instance) { consider(in, instance, out, candidates); });
  // Back to front, so that blending is right; equal distances keep the order of instances.
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance > b.distance; });
  // Marching goes where it takes away most error per area, as far as the budget reaches.
  std::vector<Candidate*> by_gain;
  for (Candidate& c : candidates) {
    if (c.deep.tile && c.deep.bound < kWorthMarching * c.flat.bound) by_gain.push_back(&c);
  }
  const auto gain = [](const Candidate* c) { return (c->flat.bound - c->deep.bound) / c->area_px; };
  std::stable_sort(by_gain.begin(), by_gain.end(),
                   [&](const Candidate* a, const Candidate* b) { return gain(a) > gain(b); });
  double left_px = in.march_budget_px;
  for (Candidate* c : by_gain) {
    if (c->area_px > left_px) continue;
    left_px -= c->area_px;
    c->march = true;
  }
  for (const Candidate& c : candidates) draw_candidate(in, c, out);
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
    if (in.scene->geometry && in.scene->surrounds(view_of.object)) return;
    if ((*in.mesh_ready)[view_of.object] && distance < in.mesh_radii) return;
    const TileGroup& group = *in.cache->group_to_draw(instance);
    if (group.empty_from(view.eye) && in.cache->lit_now(instance)) return;
    double bound = kInfinity;
    if (!group.tiles.empty()) {
      // At the edge of the view the eye depth falls; ask as if the object were looked at.
      view.center_depth = glm::length(view.eye);
      bound = best_of_all(group, object, view, in).bound;
    }
    if (!is_stale(bound, in.tau_px) && in.cache->lit_now(instance)) return;
    // Inside the swap distance a tile is no use but as a stopgap: one, until geometry comes.
    if (distance < limits::kMinCaptureRadii && !group.tiles.empty()) return;
    TileNeed need = need_for_view(view, in.tau_px);
    need.instance = instance;
    // Something quick first: a quarter of the edge is a sixteenth of the bytes.
    if (group.tiles.empty()) {
      need.size_class = static_cast<std::uint8_t>(std::max(need.size_class - kCoarseClasses, 0));
    }
    need.error_px = std::isfinite(bound) ? std::min(bound, 2 * size) : 2 * std::min(size, 1e4);
    // Any image is better than none, however soon it ages.
    const double speed = in.speed_mps / view_of.world_from_object.scale;
    const double life =
        group.tiles.empty() ? kLongestLife : expected_life_s(view, in.tau_px, speed);
    need.gain = need.error_px * life;
    out.push_back(need);
  });
  std::stable_sort(out.begin(), out.end(),
                   [](const TileNeed& a, const TileNeed& b) { return a.gain > b.gain; });
  return out;
}

std::vector<std::uint32_t> Selector::mesh_needs(const SelectorInput& in) const {
  std::vector<std::uint32_t> out;
  const bool all = !in.method.automatic && in.method.method == DrawMethod::kMesh;
  bool surroundings_missing = false;
  in.scene->for_visible(in.predicted, kViewGuard, [&](std::uint32_t instance) {
    const InstanceView& view_of = in.scene->instances[instance];
    if ((*in.mesh_ready)[view_of.object]) return;
    const double distance = glm::length(view_of.center - in.predicted.pose.eye);
    const bool near = distance < kMeshPrefetch * in.mesh_radii * view_of.radius;
    const bool surrounds = in.scene->surrounds(view_of.object);
    if (all || near || surrounds) out.push_back(view_of.object);
    surroundings_missing = surroundings_missing || surrounds;
  });
  // What one stands in comes before single objects.
  if (surroundings_missing && !all) {
    out.erase(std::remove_if(out.begin(), out.end(),
                             [&](std::uint32_t object) { return !in.scene->surrounds(object); }),
              out.end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace mirage

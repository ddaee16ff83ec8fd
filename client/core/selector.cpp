#include "client/core/selector.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/core/eight_views.h"
#include "client/core/importance.h"
#include "client/core/motion_need.h"
#include "protocol/limits.h"
#include "protocol/need_mask.h"
#include "protocol/stable_math.h"

namespace mirage {
namespace {

// Nearer, in radii, no picture of the object can stand for it: the eye is in its sphere.
constexpr double kInsideRadii = 1 + 1e-6;
constexpr double kMinRadiusPx = 0.5;   // smaller objects are neither drawn nor asked for
constexpr double kViewGuard = 0.0873;  // 5 degrees around the predicted view
constexpr std::int64_t kFadeUs = 120'000;
constexpr double kMeshPrefetch = 1.3;       // times the swap distance
constexpr std::uint32_t kTileBytes = 1500;  // of a middling tile, as it travels
constexpr double kMeshHysteresis = 1.15;
constexpr double kWorthMarching = 0.7;  // of the flat bound
// A newer tile replaces the one shown only when it is clearly better, or the old one too bad.
constexpr double kSwitchRatio = 0.6;
// A group stands for its members where it is far and its image lasts, even at a walk.
constexpr double kGroupRadii = 4;
constexpr double kGroupLifeS = 3;
constexpr double kWalkingMps = 1.4;
// Deepest step in an object's depth, in radii, before a tile has told.
constexpr double kTypicalGap = 0.6;
constexpr double kQuantumShare = 0.01;  // 8-bit depth and the slope within a texel, in radii

// Beyond so many radii a tile may stand in for geometry that is there, when it is drawn for less
// (a triangle costs as much as so many pixels of a quad, or more) and lasts.
constexpr double kStandInRadii = 3;
constexpr double kStandInLifeS = 3;
constexpr double kPixelsPerTriangle = 16;

// False for NaN.
bool outside(const ViewGeometry& view) {
  return glm::length(view.eye) > kInsideRadii * view.radius && is_finite(view.eye);
}

double fade_progress(std::int64_t since_us, std::int64_t now_us) {
  return std::clamp(static_cast<double>(now_us - since_us) / kFadeUs, 0.0, 1.0);
}

// The error in px this instance may show now.
double allowed_px(const SelectorInput& in, const Camera& camera, const InstanceView& view) {
  const double looked_at = attention(camera, in.cursor_px, view);
  return allowed_error_px(in.tau_px, in.target_px, looked_at, view.importance);
}

ViewPlan plan_for(const SelectorInput& in, const InstanceView& view, const TileGroup& tiles,
                  double radius, double tau_px) {
  ViewPlan plan;
  plan.tau_px = tau_px;
  const glm::dquat inverse = glm::conjugate(glm::dquat(view.world_from_object.rotation));
  plan.velocity = inverse * in.velocity / double{view.world_from_object.scale};
  const bool flat = !in.method.automatic && in.method.method != DrawMethod::kDepth;
  const bool still = glm::length(in.velocity) < 0.02;
  if (flat || still) return plan;  // a still eye is served best, and cheapest, by a quad
  double gap = kTypicalGap;
  if (!tiles.tiles.empty()) gap = tiles.tiles.back()->measure.depth_gap / radius;
  plan.depth_share = std::max(gap / kHoleTolerance, kQuantumShare);
  return plan;
}

// Seconds an image of the group lasts at a walk; members beyond kGroupRadii only.
bool group_wanted(const SelectorInput& in, const InstanceView& view_of, const ViewGeometry& view,
                  double tau_px, double slack) {
  if (in.method.eight_views) return false;
  if (glm::length(view.eye) * slack < kGroupRadii * view.radius) return false;
  ViewPlan plan;
  plan.tau_px = tau_px;
  plan.depth_share = kTypicalGap / kHoleTolerance;
  const double speed = std::max(glm::length(in.velocity), kWalkingMps);
  plan.velocity = glm::dvec3(speed / view_of.world_from_object.scale, 0, 0);
  return expected_life_s(view, plan) * slack >= kGroupLifeS;
}

// What the light of the group costs by being past; 0 when it is not.
double light_change_px(const SelectorInput& in, const TileCache::LitGroup& lit,
                       std::uint32_t instance, double radius_px) {
  if (!lit.then) return 0;
  const InstanceView& view = in.scene->instances[instance];
  return light_error_px(lit.then->lighting, in.cache->lights().current().lighting, view,
                        in.scene->objects[view.object], radius_px);
}

void add_eight_view_need(const SelectorInput& in, std::uint32_t instance, const ViewGeometry& view,
                         const TileCache::LitGroup& lit, std::vector<TileNeed>& out) {
  const TileGroup none;
  std::optional<TileNeed> need =
      eight_view_need(lit.wanted ? *lit.tiles : none, view, radius_px(view));
  if (!need) return;
  need->instance = instance;
  need->light = in.cache->light();
  out.push_back(*need);
}

// Sent once, such geometry costs less than any one tile, and is right from everywhere.
bool cheaper_than_tiles(const ObjectDescription& object) {
  constexpr NeedMask kImages = kNeedBaseColorMap | kNeedMetalRoughMap | kNeedNormalMap |
                               kNeedOcclusionMap | kNeedEmissiveMap;
  return !object.lods.empty() && object.lods[0].bytes <= kTileBytes && !(object.needs & kImages);
}

// Nearer than this the object is geometry, if it is there.
double swap_radii(const SelectorInput& in, const ObjectDescription& object) {
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  if (!in.method.automatic && in.method.method == DrawMethod::kMesh) return kEverywhere;
  if (object.surrounds) return kEverywhere;
  const bool cheap = in.method.automatic && in.mesh_radii > 0 && cheaper_than_tiles(object);
  return cheap ? kEverywhere : in.mesh_radii;
}

// Whether a flat tile of the object is cheaper to draw than its geometry, and may replace it.
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

}  // namespace

void Selector::reset(const SceneView& scene) { shown_.assign(scene.instances.size(), Shown{}); }

struct Selector::Candidate {
  std::uint32_t instance = 0;
  const TileGroup* group = nullptr;
  const ObjectDescription* object = nullptr;
  ViewGeometry view;
  double distance = 0;
  double tau_px = 1;  ///< what is allowed
  double area_px = 0;
  std::int64_t light_lag_us = 0;
  float fade = 1;
  bool under_mesh = false;  ///< geometry already covers most of it
  TileFit flat;
  TileFit deep;
  bool march = false;
};

struct Selector::Walk {
  const SelectorInput& in;
  DrawList& out;
  std::vector<Candidate> candidates;
};

bool Selector::drawn_as_mesh(const SelectorInput& in, std::uint32_t instance) const {
  const InstanceView& view = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view.object];
  if (object.group || !(*in.mesh_ready)[view.object]) return false;
  const double distance = glm::length(view.center - in.camera.pose.eye);
  const double slack = shown_[instance].as_mesh ? kMeshHysteresis : 1.0;
  return distance < slack * swap_radii(in, object) * view.radius;
}

// A tile that shows the same for less than the geometry would.
bool Selector::stands_in(const SelectorInput& in, const Candidate& c) const {
  if (c.group->tiles.empty() || c.light_lag_us > 0) return false;
  if (!may_stand_in(in, *c.object, c.view, c.tau_px)) return false;
  const double slack = shown_[c.instance].as_mesh ? 1.0 : kMeshHysteresis;
  return best_flat(*c.group, *c.object, c.view, c.tau_px).settled(slack * c.tau_px);
}

// Adds the instance to the candidates or the lists, if it is drawn at all.
void Selector::consider(Walk& w, std::uint32_t instance, float fade) {
  const SelectorInput& in = w.in;
  const InstanceView& view_of = in.scene->instances[instance];
  Candidate c;
  c.instance = instance;
  c.object = &in.scene->objects[view_of.object];
  c.view = view_geometry(in.camera, view_of, *c.object, in.time_s);
  c.fade = fade;
  const double size = radius_px(c.view);
  if (c.object->radius <= 0 || size < kMinRadiusPx) return;
  ++w.out.visible;
  c.tau_px = allowed_px(in, in.camera, view_of);
  c.distance = glm::length(view_of.center - in.camera.pose.eye);
  Shown& shown = shown_[instance];
  const TileCache::LitGroup lit = in.cache->lit_group(instance);
  c.group = lit.tiles;
  if (lit.then && light_change_px(in, lit, instance, size) > c.tau_px) {
    c.light_lag_us = in.now_us - lit.then->ended_us;
  }
  const bool as_mesh = drawn_as_mesh(in, instance) && !stands_in(in, c);
  if (as_mesh != shown.as_mesh) {
    const bool was_drawn = shown.frame > 0 && shown.frame + 1 >= in.frame;
    shown.swapped_us = was_drawn ? in.now_us : INT64_MIN / 2;
    shown.as_mesh = as_mesh;
  }
  if (!c.object->group) shown.frame = in.frame;
  // What takes over fades in over what was there: geometry dithered, a tile blended.
  const auto progress = static_cast<float>(fade_progress(shown.swapped_us, in.now_us));
  const bool swapping = progress < 1 && (*in.mesh_ready)[view_of.object];
  if (as_mesh) {
    w.out.meshes.push_back({instance, 0, std::min(fade, progress)});
    if (!swapping) {
      shown.tile.reset();
      shown.former.reset();
      return;
    }
  } else if (swapping) {
    w.out.meshes.push_back({instance, 0, fade});
    c.fade = std::min(fade, progress);
  }
  c.under_mesh = as_mesh && progress >= 0.5f;
  const bool on_mesh = as_mesh || swapping;
  if (c.group->empty_from(c.view.eye)) return;
  const bool useless = c.group->tiles.empty() || !outside(c.view);
  if (useless && on_mesh) return;
  if (useless) {
    if (!c.object->group) w.out.placeholders.push_back({instance, c.distance});
    ++w.out.over_tau;
    return;
  }
  if (in.method.automatic) {
    c.flat = best_flat(*c.group, *c.object, c.view, c.tau_px);
    if (!c.flat.meets(c.tau_px)) c.deep = best_deep(*c.group, *c.object, c.view, c.tau_px);
  } else {
    c.flat = best_fit(*c.group, *c.object, c.view, in.method, c.tau_px);
  }
  const double screen = static_cast<double>(in.camera.width) * in.camera.height;
  c.area_px = std::min(3.14159 * size * size, screen);
  w.candidates.push_back(std::move(c));
}

bool Selector::group_serves(const SelectorInput& in, std::uint32_t group,
                            const ViewGeometry& view) const {
  const InstanceView& view_of = in.scene->instances[group];
  const bool was_drawn = shown_[group].frame + 1 >= in.frame && in.frame > 0;
  const double slack = was_drawn ? kMeshHysteresis : 1.0;
  const double tau = allowed_px(in, in.camera, view_of);
  if (!group_wanted(in, view_of, view, tau, slack)) return false;
  const TileGroup& tiles = *in.cache->group_to_draw(group);
  if (tiles.empty_from(view.eye)) return true;
  const ObjectDescription& object = in.scene->objects[view_of.object];
  const TileFit fit = best_fit(tiles, object, view, in.method, tau);
  return fit.meets(tau * slack) || (fit.tile && !members_have_images(in, group));
}

bool Selector::members_have_images(const SelectorInput& in, std::uint32_t group) const {
  for (const std::uint32_t member : in.scene->members(group)) {
    const bool nested = in.scene->objects[in.scene->instances[member].object].group;
    const bool shows = nested
                           ? members_have_images(in, member)
                           : drawn_as_mesh(in, member) || in.cache->group_to_draw(member)->known();
    if (!shows) return false;
  }
  return true;
}

// A group takes over from its members, or they from it, by fading in over what was there.
void Selector::walk_group(Walk& w, std::uint32_t group, float fade) {
  const SelectorInput& in = w.in;
  const InstanceView& view_of = in.scene->instances[group];
  const ViewGeometry view = view_geometry(in.camera, view_of, in.scene->objects[view_of.object]);
  Shown& shown = shown_[group];
  const bool was_drawn = shown.frame > 0 && shown.frame + 1 >= in.frame;
  if (group_serves(in, group, view)) {
    if (!was_drawn) shown.appeared_us = members_have_images(in, group) ? in.now_us : INT64_MIN / 2;
    shown.frame = in.frame;
    shown.left_us = INT64_MIN / 2;
    const auto progress = static_cast<float>(fade_progress(shown.appeared_us, in.now_us));
    if (progress < 1) {
      for (const std::uint32_t member : in.scene->members(group)) walk(w, member, fade);
    }
    consider(w, group, std::min(fade, progress));
    return;
  }
  if (was_drawn) shown.left_us = in.now_us;
  const auto progress = static_cast<float>(fade_progress(shown.left_us, in.now_us));
  if (progress < 1) consider(w, group, fade);
  for (const std::uint32_t member : in.scene->members(group)) {
    walk(w, member, std::min(fade, progress));
  }
}

void Selector::walk(Walk& w, std::uint32_t instance, float fade) {
  const InstanceView& view_of = w.in.scene->instances[instance];
  const Camera& camera = w.in.camera;
  if (!camera.may_see(view_of.center - camera.pose.eye, view_of.radius)) return;
  if (w.in.scene->objects[view_of.object].group) return walk_group(w, instance, fade);
  consider(w, instance, fade);
}

void Selector::draw_candidate(const SelectorInput& in, const Candidate& c, DrawList& out) {
  TileFit best = c.march ? c.deep : c.flat;
  Shown& shown = shown_[c.instance];
  const std::vector<TileRecordPtr>& held = c.group->tiles;
  const bool still_held = std::find(held.begin(), held.end(), shown.tile) != held.end();
  if (still_held && shown.tile != best.tile) {
    const TileFit present = fit_of(shown.tile, best.method, *c.object, c.view);
    if (present.meets(c.tau_px) && present.error_px() * kSwitchRatio < best.error_px()) {
      best = present;
    }
  }
  if (shown.tile != best.tile) {
    // Two poses over one another would be a ghost, and a phase is shorter than a fade.
    const bool same_pose = still_held && shown.tile->phase == best.tile->phase;
    shown.former = same_pose ? shown.tile : nullptr;
    shown.tile = best.tile;
    shown.since_us = in.now_us;
  }
  // A former tile that left the cache meanwhile has no texels of its own any more.
  if (std::find(held.begin(), held.end(), shown.former) == held.end()) shown.former.reset();
  double fade = c.fade;
  if (shown.former) {
    const double progress = fade_progress(shown.since_us, in.now_us);
    if (progress >= 1) {
      shown.former.reset();
    } else {
      const TileFit under = fit_of(shown.former, best.method, *c.object, c.view);
      shown.former->last_drawn = in.frame;
      out.impostors.push_back(
          {c.instance, under.tile, under.method, under.bound_px, c.distance, c.fade});
      out.impostors.back().light_lag_us = c.light_lag_us;
      fade = std::min(fade, progress);
    }
  }
  best.tile->last_drawn = in.frame;
  best.tile->shown = true;
  out.impostors.push_back(
      {c.instance, best.tile, best.method, best.bound_px, c.distance, static_cast<float>(fade)});
  out.impostors.back().light_lag_us = c.light_lag_us;
  if (!c.under_mesh && is_stale(best.bound_px, c.tau_px)) ++out.over_tau;
}

DrawList Selector::select(const SelectorInput& in) {
  DrawList out;
  out.time_s = in.time_s;
  Walk w{in, out, {}};
  in.scene->for_visible_roots(in.camera, 0, [&](std::uint32_t root) { walk(w, root, 1); });
  // Back to front, so that blending is right; equal distances keep the order of instances.
  std::stable_sort(w.candidates.begin(), w.candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance > b.distance; });
  // Marching goes where it takes away most error per area, as far as the budget reaches.
  std::vector<Candidate*> by_gain;
  for (Candidate& c : w.candidates) {
    if (c.deep.tile && c.deep.error_px() < kWorthMarching * c.flat.error_px())
      by_gain.push_back(&c);
  }
  const auto gain = [](const Candidate* c) {
    return (std::min(c->flat.error_px(), 1e6) - c->deep.error_px()) / c->area_px;
  };
  std::stable_sort(by_gain.begin(), by_gain.end(),
                   [&](const Candidate* a, const Candidate* b) { return gain(a) > gain(b); });
  double left_px = in.march_budget_px;
  for (Candidate* c : by_gain) {
    if (c->area_px > left_px) continue;
    left_px -= c->area_px;
    c->march = true;
  }
  for (const Candidate& c : w.candidates) draw_candidate(in, c, out);
  return out;
}

void Selector::add_need(const SelectorInput& in, std::uint32_t instance,
                        std::vector<TileNeed>& out) const {
  const InstanceView& view_of = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view_of.object];
  ViewGeometry view = view_geometry(in.predicted, view_of, object, in.time_s);
  const double size = radius_px(view);
  if (object.radius <= 0 || size < kMinRadiusPx) return;
  if (!outside(view)) return;
  const double distance = glm::length(view.eye) / view.radius;
  if (in.scene->geometry && object.surrounds) return;
  const double tau = allowed_px(in, in.predicted, view_of);
  const bool stand_in = (*in.mesh_ready)[view_of.object] && distance < swap_radii(in, object);
  if (stand_in && !may_stand_in(in, object, view, tau)) return;
  const TileCache::LitGroup lit = in.cache->lit_group(instance);
  const TileGroup& group = *lit.tiles;
  if (group.empty_from(view.eye)) return;  // under any light
  // At the edge of the view the eye depth falls; ask as if the object were looked at.
  view.center_depth = glm::length(view.eye);
  if (in.method.eight_views) return add_eight_view_need(in, instance, view, lit, out);
  if (object.motion.moving()) return add_moving_needs(in, instance, view, lit, tau, out);
  ViewPlan plan = plan_for(in, view_of, group, view.radius, tau);
  if (stand_in) plan.depth_share = kFlatDepthShare;
  if (stand_in && expected_life_s(view, plan) < kStandInLifeS) return;
  TileFit fit;
  if (!group.tiles.empty()) {
    const bool still = plan.depth_share == kFlatDepthShare;
    fit = still && in.method.automatic ? best_flat(group, object, view, tau)
                                       : best_fit(group, object, view, in.method, tau);
  }
  const double light_px = light_change_px(in, lit, instance, size);
  // Shaded here it is right, and yet not as good as shaded by the server: when there is time.
  const bool shaded_here = !in.cache->wants_relit(instance) && fit.tile && fit.tile->relit;
  if (fit.settled(tau) && !is_stale(light_px, tau) && !shaded_here) return;
  // Inside the swap distance a tile is no use but as a stopgap: one, until geometry comes.
  if (distance < limits::kMinCaptureRadii && !group.tiles.empty()) return;
  TileNeed need = need_for_view(view, plan);
  need.instance = instance;
  // Something quick first: a quarter of the edge is a sixteenth of the bytes.
  if (group.tiles.empty() && !stand_in) need.size_class = coarse_class(need.size_class);
  need.channels = in.cache->wants_relit(instance) ? kRelitTile : kLitTile;
  need.light = in.cache->light();
  need.error_px = std::max(displayed_error_px(fit, size), std::min(light_px, 2 * size));
  // Any image is better than none, however soon it ages.
  need.gain = need.error_px * (group.tiles.empty() ? kLongestLife : expected_life_s(view, plan));
  if (stand_in) need.gain = std::min(need.gain, tau * kStandInLifeS);  // it only saves work
  out.push_back(need);
}

std::vector<TileNeed> Selector::needs(const SelectorInput& in) const {
  std::vector<TileNeed> out;
  if (!in.method.automatic && in.method.method == DrawMethod::kMesh) return out;
  const std::function<void(std::uint32_t)> visit = [&](std::uint32_t i) {
    const InstanceView& view_of = in.scene->instances[i];
    const glm::dvec3 to_center = view_of.center - in.predicted.pose.eye;
    if (!in.predicted.may_see(to_center, view_of.radius, kViewGuard)) return;
    const ObjectDescription& object = in.scene->objects[view_of.object];
    if (object.group && !group_wanted(in, view_of, view_geometry(in.predicted, view_of, object),
                                      allowed_px(in, in.predicted, view_of), 1)) {
      for (const std::uint32_t member : in.scene->members(i)) visit(member);
      return;
    }
    const std::size_t first = out.size();
    add_need(in, i, out);
    // Any image beats none. Without a cursor nobody is known to look: the middle first cost the
    // whole picture 1.6 % of FLIP on the forest walk.
    const bool ranks = in.cursor_px && in.cache->group_to_draw(i)->known();
    const double looked_at = ranks ? attention(in.predicted, in.cursor_px, view_of) : 1;
    const double urgency = looked_at / tolerance(view_of.importance);
    for (std::size_t k = first; k < out.size(); ++k) out[k].gain *= urgency;
  };
  in.scene->for_visible_roots(in.predicted, kViewGuard, visit);
  std::stable_sort(out.begin(), out.end(),
                   [](const TileNeed& a, const TileNeed& b) { return a.gain > b.gain; });
  TileCache::Room room = in.cache->room(in.frame);
  out.erase(std::remove_if(out.begin(), out.end(),
                           [&](TileNeed& need) { return !fit_to_atlas(in, room, need); }),
            out.end());
  return out;
}

bool Selector::fit_to_atlas(const SelectorInput& in, TileCache::Room& room, TileNeed& need) {
  if (!is_picture(need.channels)) return true;
  const TileGroup& group = *in.cache->group_to_draw(need.instance);
  std::uint32_t shown_edge = 0;
  for (const TileRecordPtr& tile : group.tiles) {
    if (tile->last_drawn == in.frame) shown_edge = std::max(shown_edge, tile->capture.edge);
  }
  const std::size_t kept = shown_edge > 0 ? room.reserved : 0;
  const std::size_t left = room.texels - std::min(room.texels, kept);
  const std::uint8_t wanted = need.size_class;
  const auto fits = [&] {
    const std::uint32_t edge = tile_edge(need.size_class);
    return edge < room.edge && in.cache->footprint(edge) <= left;
  };
  while (!fits()) {
    if (need.size_class == 0) return false;
    --need.size_class;
  }
  const std::uint32_t edge = tile_edge(need.size_class);
  if (need.size_class < wanted && edge <= shown_edge) return false;
  const InstanceView& view = in.scene->instances[need.instance];
  const Capture capture(need.cell, need.distance, in.scene->objects[view.object].radius, edge);
  const bool relit = need.channels == kRelitTile;
  if (in.cache->holds(need.instance, capture, relit, need.phase, need.light)) return false;
  if (room.texels != SIZE_MAX) room.texels -= std::min(room.texels, in.cache->footprint(edge));
  return true;
}

std::vector<std::uint32_t> Selector::mesh_needs(const SelectorInput& in) const {
  std::vector<std::uint32_t> out;
  in.scene->for_visible(in.predicted, kViewGuard, [&](std::uint32_t instance) {
    const InstanceView& view_of = in.scene->instances[instance];
    const double distance = glm::length(view_of.center - in.predicted.pose.eye);
    const double swap = swap_radii(in, in.scene->objects[view_of.object]);
    if (distance < kMeshPrefetch * swap * view_of.radius) out.push_back(instance);
  });
  return out;
}

}  // namespace mirage

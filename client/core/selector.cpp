#include "client/core/selector.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/core/blend_order.h"
#include "client/core/selector_rules.h"
#include "protocol/need_mask.h"

namespace mirage {
namespace {

constexpr std::int64_t kFadeUs = 120'000;
constexpr double kWorthMarching = 0.7;  // of the flat bound
// A newer tile replaces the one shown only when it is clearly better, or the old one too bad.
constexpr double kSwitchRatio = 0.6;
// How long a choice is kept that is still good enough.
constexpr std::int64_t kReconsiderUs = 100'000;

double fade_progress(std::int64_t since_us, std::int64_t now_us) {
  return std::clamp(static_cast<double>(now_us - since_us) / kFadeUs, 0.0, 1.0);
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
  std::size_t considered = SIZE_MAX;  ///< its place in considered_, with a plan
  bool kept = false;  ///< `flat` is what was chosen before
};

struct Selector::Walk {
  const SelectorInput& in;
  DrawList& out;
  Frustum frustum;
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
  const TileFit fit = best_flat(*c.group, *c.object, c.view, c.tau_px);
  return fit.meets(slack * c.tau_px) && fit.sharp(slack * c.tau_px);
}

// The level that has come first may show less than a tile, or the view, that is there.
bool Selector::better_than_mesh(const SelectorInput& in, const Candidate& c) const {
  if (!in.meshes || !in.method.automatic || c.object->surrounds) return false;
  const double mesh_px = in.meshes->error_px(*in.scene, in.camera, c.instance);
  if (mesh_px <= c.tau_px) return false;
  const InstanceView& view_of = in.scene->instances[c.instance];
  double other_px = std::numeric_limits<double>::infinity();
  // Its seams count as what a thinned level spreads.
  constexpr double kBehind = 1 / kSpreadPerTau;
  if (in.view) other_px = in.view->error_px(view_of, in.camera, kBehind).value_or(other_px);
  if (!c.group->tiles.empty() && outside(c.view)) {
    const TileFit fit = best_flat(*c.group, *c.object, c.view, c.tau_px);
    other_px = std::min(other_px, displayed_error_px(fit, radius_px(c.view), c.tau_px));
  }
  const double slack = shown_[c.instance].as_mesh ? kWorthMarching : 1;
  return other_px < slack * mesh_px;
}

// From where the view was taken, or near enough that it is not torn.
bool Selector::view_shows(const SelectorInput& in, const Candidate& c) {
  if (!in.view) return false;
  const std::optional<double> px = in.view->error_px(in.scene->instances[c.instance], in.camera);
  return px && *px <= kFirstImagePx * c.tau_px;
}

// What the instance could be drawn as; `geometry`: also as that.
Alternatives Selector::alternatives(const SelectorInput& in, const Candidate& c,
                                    bool geometry) const {
  const InstanceView& view_of = in.scene->instances[c.instance];
  Alternatives out;
  out.area_px = shown_area_px(in.camera, view_of.center - in.camera.pose.eye, view_of.radius);
  out.alpha_tested = c.object->needs & kNeedAlphaMask;
  const bool pictured = !c.group->tiles.empty() && outside(c.view);
  if (pictured) {
    const auto tile_of = [&](const TileFit& fit) {
      const double edge = fit.tile->capture.edge;
      const double share = fit.tile->crop.w * fit.tile->crop.h / (edge * edge);
      return Alternatives::Tile{fit.error_px(c.tau_px), fit.texel_px, share};
    };
    out.flat = tile_of(best_flat(*c.group, *c.object, c.view, c.tau_px));
  }
  if (in.view) out.view_px = in.view->error_px(view_of, in.camera);
  if (!geometry) return out;
  out.mesh_only = c.object->surrounds;
  const std::optional<std::size_t> level =
      in.meshes ? in.meshes->level(*in.scene, in.camera, c.tau_px, c.instance) : std::nullopt;
  const std::vector<LodInfo>& lods = c.object->lods;
  if (level && *level < lods.size()) {
    out.triangles = lods[*level].triangles;
    out.mesh_px = lod_excess(lods[*level], px_per_unit(*in.scene, in.camera, c.instance), 1);
  }
  return out;
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
  bool as_mesh = drawn_as_mesh(in, instance);
  if (in.plan) {
    c.considered = considered_.size();
    considered_.push_back(alternatives(in, c, as_mesh));
    as_mesh = as_mesh && in.plan->mesh_pays(considered_.back(), shown.as_mesh);
  } else {
    as_mesh = as_mesh && !stands_in(in, c) && !better_than_mesh(in, c);
  }
  if (as_mesh != shown.as_mesh) {
    const bool was_drawn = shown.frame > 0 && shown.frame + 1 >= in.frame;
    shown.swapped_us = was_drawn ? in.now_us : INT64_MIN / 2;
    shown.as_mesh = as_mesh;
  }
  if (in.scene->members(instance).empty()) shown.frame = in.frame;
  // What takes over fades in over what was there: geometry dithered, a tile blended.
  auto progress = static_cast<float>(fade_progress(shown.swapped_us, in.now_us));
  if (progress < 1 && c.group->tiles.empty() && !view_shows(in, c)) progress = 1;
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
    // The hull of what moves is where it ever is: a ghost.
    const bool stands = !c.object->group && !c.object->motion.moving();
    if (stands) w.out.placeholders.push_back({instance, c.distance});
    ++w.out.over_tau;
    return;
  }
  c.kept = keep_chosen(in, c);
  if (in.method.automatic && !c.kept) {
    c.flat = best_flat(*c.group, *c.object, c.view, c.tau_px);
    if (!c.flat.meets(c.tau_px)) c.deep = best_deep(*c.group, *c.object, c.view, c.tau_px);
  } else if (!c.kept) {
    c.flat = best_fit(*c.group, *c.object, c.view, in.method, c.tau_px);
  }
  const double screen = static_cast<double>(in.camera.width) * in.camera.height;
  c.area_px = std::min(3.14159 * size * size, screen);
  w.candidates.push_back(std::move(c));
}

// A flat tile that was chosen a moment ago and still meets tau is drawn on, if none has come since.
bool Selector::keep_chosen(const SelectorInput& in, Candidate& c) const {
  const Shown& shown = shown_[c.instance];
  if (in.now_us >= shown.chosen_until_us || c.group->tiles.back()->serial != shown.newest) {
    return false;
  }
  const std::vector<TileRecordPtr>& held = c.group->tiles;
  if (std::find(held.begin(), held.end(), shown.tile) == held.end()) return false;
  c.flat = fit_of(shown.tile, shown.method, *c.object, c.view);
  return c.flat.meets(c.tau_px);
}

bool Selector::group_serves(const SelectorInput& in, std::uint32_t group,
                            const ViewGeometry& view) const {
  const InstanceView& view_of = in.scene->instances[group];
  const bool was_drawn = shown_[group].frame + 1 >= in.frame && in.frame > 0;
  const double slack = was_drawn ? kMeshHysteresis : 1.0;
  if (in.scene->objects[view_of.object].cut) {
    const bool near = glm::length(view.eye) * slack < kPartRadii * view.radius;
    const bool pictured = outside(view) && in.cache->group_to_draw(group)->known();
    return drawn_as_mesh(in, group) || !near || (pictured && !members_have_images(in, group));
  }
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
  if (!w.frustum.may_see(view_of.center - w.in.camera.pose.eye, view_of.radius)) return;
  const bool parts = !w.in.scene->members(instance).empty();
  if (parts || w.in.scene->objects[view_of.object].group) return walk_group(w, instance, fade);
  consider(w, instance, fade);
}

void Selector::draw_candidate(const SelectorInput& in, const Candidate& c, DrawList& out) {
  TileFit best = c.march ? c.deep : c.flat;
  Shown& shown = shown_[c.instance];
  const std::vector<TileRecordPtr>& held = c.group->tiles;
  const bool still_held = std::find(held.begin(), held.end(), shown.tile) != held.end();
  if (still_held && shown.tile != best.tile) {
    const TileFit present = fit_of(shown.tile, best.method, *c.object, c.view);
    if (present.meets(c.tau_px) && (present.sharp(c.tau_px) || !best.sharp(c.tau_px)) &&
        present.error_px(c.tau_px) * kSwitchRatio < best.error_px(c.tau_px)) {
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
  if (!c.kept) {
    const bool keeps = in.method.automatic && !c.object->motion.moving() &&
                       best.method != DrawMethod::kDepth && best.meets(c.tau_px);
    shown.chosen_until_us = keeps ? in.now_us + kReconsiderUs : INT64_MIN / 2;
    shown.method = best.method;
    shown.newest = held.back()->serial;
  }
  best.tile->last_drawn = in.frame;
  best.tile->shown = true;
  out.impostors.push_back(
      {c.instance, best.tile, best.method, best.bound_px, c.distance, static_cast<float>(fade)});
  out.impostors.back().light_lag_us = c.light_lag_us;
  if (!c.under_mesh && is_stale(best.bound_px, c.tau_px)) ++out.over_tau;
}

bool Selector::march_pays(const SelectorInput& in, const Candidate& c) {
  Alternatives& thing = considered_[c.considered];
  const double edge = c.deep.tile->capture.edge;
  const double share = c.deep.tile->crop.w * c.deep.tile->crop.h / (edge * edge);
  thing.deep = Alternatives::Tile{c.deep.error_px(c.tau_px), c.deep.texel_px, share};
  const bool marched = shown_[c.instance].method == DrawMethod::kDepth;
  return in.plan->march_pays(thing, marched);
}

DrawList Selector::select(const SelectorInput& in) {
  considered_.clear();
  DrawList out;
  out.time_s = in.time_s;
  Walk w{in, out, Frustum(in.camera), {}};
  in.scene->for_visible_roots(in.camera, 0, [&](std::uint32_t root) { walk(w, root, 1); });
  // Back to front by the far side, so that blending is right and what stands on or in another thing
  // comes after it; equals keep the order of instances.
  using Ranked = std::pair<double, Candidate*>;
  const auto larger = [](const Ranked& a, const Ranked& b) { return a.first > b.first; };
  std::vector<Ranked> by_far_side, by_gain;
  for (Candidate& c : w.candidates) {
    by_far_side.emplace_back(c.distance + in.scene->instances[c.instance].radius, &c);
  }
  std::stable_sort(by_far_side.begin(), by_far_side.end(), larger);
  // Marching goes where it takes away most error per area, as far as the budget reaches.
  for (const auto& [far_side, c] : by_far_side) {
    if (!c->deep.tile) continue;
    if (in.plan && !march_pays(in, *c)) continue;
    const double deep = c->deep.error_px(c->tau_px), flat = c->flat.error_px(c->tau_px);
    if (deep < kWorthMarching * flat) {
      by_gain.emplace_back((std::min(flat, 1e6) - deep) / c->area_px, c);
    }
  }
  std::stable_sort(by_gain.begin(), by_gain.end(), larger);
  double left_px = in.march_budget_px;
  for (const auto& [gain, c] : by_gain) {
    if (c->area_px > left_px) continue;
    left_px -= c->area_px;
    c->march = true;
  }
  for (const auto& [far_side, candidate] : by_far_side) draw_candidate(in, *candidate, out);
  sort_for_blending(out.impostors, *in.scene, in.camera.pose.eye);
  return out;
}

}  // namespace mirage

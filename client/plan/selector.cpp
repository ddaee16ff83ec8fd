#include "client/plan/selector.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/frame/asset_id.h"
#include "client/frame/draw_list.h"
#include "client/hold/mesh_cache.h"
#include "client/hold/tile_cache.h"
#include "client/plan/alternatives.h"
#include "client/plan/blend_order.h"
#include "client/plan/frame_plan.h"
#include "client/plan/selector_input.h"
#include "client/plan/selector_rules.h"
#include "client/plan/tile_fit.h"
#include "client/plan/tile_need.h"
#include "client/price/view_fit.h"
#include "client/scene/scene_view.h"
#include "protocol/base/order.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/model/need_mask.h"

namespace mirage {
namespace {

constexpr std::int64_t kFadeUs = 120'000;
constexpr double kAlike = 2;  // of tau: error up to which a see-through tile is replaced at once
// A newer tile replaces the one shown only if it is clearly better, or if the old one is too bad.
constexpr double kSwitchRatio = 0.6;
// Time for which a choice is kept while it is good enough.
constexpr std::int64_t kReconsiderUs = 100'000;

// True if one sees between the parts of the object.
bool see_through(const ObjectDescription& object) {
  return (object.needs & (kNeedAlphaMask | kNeedBlend)) != 0 || object.triangles == 0;
}

double fade_progress(std::int64_t since_us, std::int64_t now_us) {
  return std::clamp(static_cast<double>(now_us - since_us) / kFadeUs, 0.0, 1.0);
}

}  // namespace

void Selector::reset(const SceneView& scene) {
  shown_.assign(scene.instances.size(), Shown{});
  geometry_.reset(scene.objects.size());
}

void Selector::grow(const SceneView& scene) {
  shown_.resize(scene.instances.size());
  geometry_.grow(scene.objects.size());
}

struct Selector::Candidate {
  std::uint32_t instance = 0;
  const TileGroup* group = nullptr;
  const ObjectDescription* object = nullptr;
  ViewGeometry view;
  double distance = 0;
  double tau_px = 1;  ///< the error it may show
  std::int64_t light_lag_us = 0;
  float fade = 1;
  bool pictured = false;    ///< it has tiles that may be drawn
  bool under_mesh = false;  ///< geometry already covers most of it
  TileFit flat;
  TileFit deep;
  bool kept = false;  ///< `flat` is the earlier choice
  Choice choice;
};

struct Selector::Considered {
  std::vector<Candidate> candidates;
  std::size_t visible = 0;
};

struct Selector::Walk {
  const SelectorInput& in;
  Considered& out;
  std::vector<Alternatives>& things;
  Frustum frustum;
  double march_left_px;
};

Selector::Selector() : considered_(std::make_unique<Considered>()) {}
Selector::~Selector() = default;
Selector::Selector(Selector&&) noexcept = default;
Selector& Selector::operator=(Selector&&) noexcept = default;

std::size_t Selector::things_in_view() const { return considered_->candidates.size(); }

bool Selector::drawn_as_mesh(const SelectorInput& in, std::uint32_t instance) const {
  const InstanceView& view = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view.object];
  if (object.group || !(*in.mesh_ready)[view.object]) return false;
  const double distance = glm::length(view.center - in.camera.pose.eye);
  const double slack = shown_[instance].as_mesh ? kMeshHysteresis : 1.0;
  return distance < slack * swap_radii(in, object) * view.radius;
}

// True if the view tile shows the candidate as well as a first image would: the eye is near enough
// to where the view was taken.
bool Selector::view_shows(const SelectorInput& in, const Candidate& c) {
  if (!in.view) return false;
  const std::optional<double> px =
      in.view->error_px(in.scene->instances[c.instance], *c.object, in.camera, in.time_s);
  return px && *px <= kFirstImagePx * c.tau_px;
}

// Adds the resident levels of geometry: the one within tau, or the nearest to it, and coarser ones.
void Selector::add_levels(const SelectorInput& in, std::uint32_t instance,
                          Alternatives& out) const {
  const std::uint32_t object = in.scene->instances[instance].object;
  const std::vector<LodInfo>& lods = in.scene->objects[object].lods;
  if (!in.meshes) {  // resident geometry counts as exact
    out.levels.push_back({0, lods.empty() ? 0 : lods[0].triangles, 0});
    return;
  }
  const std::optional<std::size_t> best =
      in.meshes->level(*in.scene, in.camera, in.mesh_tau_px, instance);
  if (!best) return;
  const double density = px_per_unit(*in.scene, in.camera, instance);
  for (std::size_t i = *best; i < lods.size(); ++i) {
    const auto level = static_cast<std::uint8_t>(i);
    if (!in.meshes->resident({AssetId::Kind::kMesh, object, level})) continue;
    out.levels.push_back({level, lods[i].triangles, lod_excess(lods[i], density, 1)});
  }
}

// Returns the ways in which the instance could be drawn.
Alternatives Selector::alternatives(const SelectorInput& in, const Candidate& c) const {
  const InstanceView& view_of = in.scene->instances[c.instance];
  Alternatives out;
  out.instance = c.instance;
  out.object = view_of.object;
  out.area_px = shown_area_px(in.camera, view_of.center - in.camera.pose.eye, view_of.radius);
  out.alpha_tested = c.object->needs & kNeedAlphaMask;
  const auto tile_of = [&](const TileFit& fit) {
    const double edge = fit.tile->capture.edge;
    const double share = fit.tile->crop.w * fit.tile->crop.h / (edge * edge);
    const double error_px = std::max(fit.error_px(c.tau_px), unseen_px(*fit.tile, c.view));
    return Alternatives::Tile{error_px, fit.texel_px, share};
  };
  if (c.pictured) out.flat = tile_of(c.flat);
  if (c.pictured && c.deep.tile) out.deep = tile_of(c.deep);
  // Tau is the promise, and a tile within tau is not improved. Without a time limit, a flat tile
  // beyond tau is therefore no alternative to a deep one within tau.
  const bool any_time = !in.plan->limited();
  if (any_time && out.deep && c.deep.meets(c.tau_px)) out.flat.reset();
  if (in.view) {
    const std::optional<double> view_px =
        in.view->error_px(view_of, *c.object, in.camera, in.time_s);
    out.viewed = view_px && *view_px <= kTornPx;
  }
  if (drawn_as_mesh(in, c.instance)) {
    add_levels(in, c.instance, out);
    // A comparison of methods draws the same geometry with all of them.
    out.mesh_only = c.object->surrounds || !in.method.automatic;
  }
  const Shown& shown = shown_[c.instance];
  if (shown.frame == 0 || shown.frame + 1 < in.frame) return out;
  const Look tile = shown.method == DrawMethod::kDepth ? Look::kDeep : Look::kFlat;
  if (shown.as_mesh) {
    out.shown = Look::kMesh;
  } else if (shown.tile) {
    out.shown = tile;
  }
  const bool fades = fade_progress(shown.swapped_us, in.now_us) < 1;
  if (fades && out.shown) out.leaving = shown.as_mesh ? tile : Look::kMesh;
  return out;
}

// Finds the tiles that serve the candidate best.
void Selector::fit_tiles(const SelectorInput& in, Candidate& c) const {
  c.pictured = !c.group->tiles.empty() && outside(c.view) && !c.group->empty_from(c.view.eye);
  if (!c.pictured) return;
  c.kept = keep_chosen(in, c);
  if (c.kept) return;
  if (!in.method.automatic) {
    c.flat = best_fit(*c.group, *c.object, c.view, in.method, c.tau_px);
    return;
  }
  c.flat = best_flat(*c.group, *c.object, c.view, c.tau_px);
  if (!c.flat.meets(c.tau_px)) c.deep = best_deep(*c.group, *c.object, c.view, c.tau_px);
}

// Adds the instance to the candidates, unless it is too small to be drawn.
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
  if (c.object->motion.hidden_at(c.view.clip_time_s)) return;
  ++w.out.visible;
  c.tau_px = allowed_px(in, in.camera, view_of);
  c.distance = glm::length(view_of.center - in.camera.pose.eye);
  const TileCache::LitGroup lit = in.cache->lit_group(instance);
  c.group = lit.tiles;
  if (lit.then && light_change_px(in, lit, instance, size) > c.tau_px) {
    c.light_lag_us = in.now_us - lit.then->ended_us;
  }
  fit_tiles(in, c);
  w.things.push_back(alternatives(in, c));
  std::optional<Alternatives::Tile>& deep = w.things.back().deep;
  if (deep && w.things.back().area_px > w.march_left_px) deep.reset();
  if (deep) w.march_left_px -= w.things.back().area_px;
  w.out.candidates.push_back(std::move(c));
}

// Draws the candidate's geometry if it was chosen or is fading out. Returns true if no tile of it
// is drawn.
bool Selector::draw_geometry(const SelectorInput& in, Candidate& c, DrawList& out) {
  Shown& shown = shown_[c.instance];
  const bool as_mesh = c.choice.look == Look::kMesh;
  if (as_mesh != shown.as_mesh) {
    const bool was_drawn = shown.frame > 0 && shown.frame + 1 >= in.frame;
    shown.swapped_us = was_drawn ? in.now_us : INT64_MIN / 2;
    shown.as_mesh = as_mesh;
  }
  if (in.scene->members(c.instance).empty()) shown.frame = in.frame;
  if (!c.choice.fades) shown.swapped_us = INT64_MIN / 2;
  // The new way fades in over the former one: geometry is dithered, a tile is blended.
  auto progress = static_cast<float>(fade_progress(shown.swapped_us, in.now_us));
  if (progress < 1 && c.group->tiles.empty() && !view_shows(in, c)) progress = 1;
  const std::uint32_t object = in.scene->instances[c.instance].object;
  const bool swapping = progress < 1 && (*in.mesh_ready)[object];
  if (as_mesh) {
    out.meshes.push_back({c.instance, c.choice.lod, std::min(c.fade, progress)});
    if (!swapping) {
      shown.tile.reset();
      shown.former.reset();
      return true;
    }
  } else if (swapping) {
    Alternatives here;
    add_levels(in, c.instance, here);
    if (!here.levels.empty()) out.meshes.push_back({c.instance, here.levels[0].lod, c.fade});
    c.fade = std::min(c.fade, progress);
  }
  c.under_mesh = as_mesh && progress >= 0.5f;
  if (c.group->empty_from(c.view.eye)) return true;
  if (c.pictured) return false;
  if (as_mesh || swapping) return true;
  // The hull of a moving object covers all places it ever takes, so it would show a ghost.
  const bool stands = !c.object->group && !c.object->motion.moving();
  if (stands) out.placeholders.push_back({c.instance, c.distance});
  ++out.over_tau;
  return true;
}

// Keeps the flat tile chosen a moment ago if it still meets tau and no tile has arrived since.
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

bool Selector::group_serves(const Walk& w, std::uint32_t group, const ViewGeometry& view) const {
  const SelectorInput& in = w.in;
  const InstanceView& view_of = in.scene->instances[group];
  const bool was_drawn = shown_[group].frame + 1 >= in.frame && in.frame > 0;
  const double slack = was_drawn ? kMeshHysteresis : 1.0;
  if (in.scene->objects[view_of.object].cut) {
    const bool near = glm::length(view.eye) * slack < kPartRadii * view.radius;
    const bool pictured = outside(view) && in.cache->group_to_draw(group)->known();
    return drawn_as_mesh(in, group) || !near || (pictured && !members_have_images(w, group));
  }
  const double tau = allowed_px(in, in.camera, view_of);
  if (!group_wanted(in, view_of, view, tau, slack)) return false;
  const TileGroup& tiles = *in.cache->group_to_draw(group);
  if (tiles.empty_from(view.eye)) return true;
  const ObjectDescription& object = in.scene->objects[view_of.object];
  const TileFit fit = best_fit(tiles, object, view, in.method, tau);
  return fit.meets(tau * slack) || (fit.tile && !members_have_images(w, group));
}

// Members out of view do not count: nobody asks for their images.
bool Selector::members_have_images(const Walk& w, std::uint32_t group) const {
  const SelectorInput& in = w.in;
  for (const std::uint32_t member : in.scene->members(group)) {
    const InstanceView& of = in.scene->instances[member];
    if (!w.frustum.may_see(of.center - in.camera.pose.eye, of.radius)) continue;
    const bool nested = in.scene->objects[in.scene->instances[member].object].group;
    const bool shows = nested
                           ? members_have_images(w, member)
                           : drawn_as_mesh(in, member) || in.cache->group_to_draw(member)->known();
    if (!shows) return false;
  }
  return true;
}

// Fades between a group and its members: the new picture fades in over the old.
void Selector::walk_group(Walk& w, std::uint32_t group, float fade) {
  const SelectorInput& in = w.in;
  const InstanceView& view_of = in.scene->instances[group];
  const ViewGeometry view = view_geometry(in.camera, view_of, in.scene->objects[view_of.object]);
  Shown& shown = shown_[group];
  const bool was_drawn = shown.frame > 0 && shown.frame + 1 >= in.frame;
  if (group_serves(w, group, view)) {
    if (!was_drawn) shown.appeared_us = members_have_images(w, group) ? in.now_us : INT64_MIN / 2;
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
  const ObjectDescription& object = w.in.scene->objects[view_of.object];
  if (object.faces.sine < 1 &&
      faces_away(object, view_geometry(w.in.camera, view_of, object, w.in.time_s).eye)) {
    return;
  }
  const bool parts = !w.in.scene->members(instance).empty();
  if (parts || object.group) return walk_group(w, instance, fade);
  consider(w, instance, fade);
}

// Returns the former tile as it was drawn, or as its successor is: whichever errs less.
TileFit Selector::fading_out(const Shown& shown, DrawMethod method, const Candidate& c) {
  const TileFit alike = fit_of(shown.former, method, *c.object, c.view);
  if (method == shown.former_method || alike.meets(c.tau_px)) return alike;
  const TileFit before = fit_of(shown.former, shown.former_method, *c.object, c.view);
  return before.error_px(c.tau_px) < alike.error_px(c.tau_px) ? before : alike;
}

void Selector::draw_candidate(const SelectorInput& in, const Candidate& c, DrawList& out) {
  TileFit best = c.choice.look == Look::kDeep ? c.deep : c.flat;
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
    // Two poses over one another would look like a ghost, and a phase is shorter than a fade.
    const bool same_pose = still_held && shown.tile->phase == best.tile->phase;
    shown.former = same_pose ? shown.tile : nullptr;
    shown.former_method = shown.method;
    shown.tile = best.tile;
    shown.since_us = in.now_us;
  }
  // A former tile that has left the cache no longer has texels.
  if (std::find(held.begin(), held.end(), shown.former) == held.end()) shown.former.reset();
  double fade = c.fade;
  if (shown.former) {
    const double progress = fade_progress(shown.since_us, in.now_us);
    const TileFit under = fading_out(shown, best.method, c);
    // Where one sees through both, two tiles cover more than each of them.
    if (progress >= 1 || (see_through(*c.object) && under.meets(kAlike * c.tau_px))) {
      shown.former.reset();
    } else {
      out.impostors.push_back(
          {c.instance, under.tile, under.method, under.bound_px, c.distance, c.fade});
      out.impostors.back().light_lag_us = c.light_lag_us;
      fade = std::min(fade, progress);
    }
  }
  if (!c.kept) {
    const bool keeps = in.method.automatic && !c.object->moves() &&
                       best.method != DrawMethod::kDepth && best.meets(c.tau_px);
    shown.chosen_until_us = keeps ? in.now_us + kReconsiderUs : INT64_MIN / 2;
    shown.method = best.method;
    shown.newest = held.back()->serial;
  }
  out.impostors.push_back(
      {c.instance, best.tile, best.method, best.bound_px, c.distance, static_cast<float>(fade)});
  out.impostors.back().light_lag_us = c.light_lag_us;
  if (!c.under_mesh && is_stale(best.bound_px, c.tau_px)) ++out.over_tau;
}

void Selector::consider(const SelectorInput& in, std::vector<Alternatives>& things) {
  *considered_ = {};
  Walk w{in, *considered_, things, Frustum(in.camera), in.march_budget_px};
  in.scene->for_visible_roots(in.camera, 0, [&](std::uint32_t root) { walk(w, root, 1); });
}

DrawList Selector::draw(const SelectorInput& in, const Choice* choices) {
  DrawList out;
  out.time_s = in.time_s;
  out.visible = considered_->visible;
  // Sorts back to front by the far side, so that blending is right and a thing standing on or in
  // another one comes after it. Equals keep the order of instances.
  using Ranked = std::pair<double, Candidate*>;
  std::vector<Ranked> by_far_side;
  for (Candidate& c : considered_->candidates) {
    c.choice = *choices++;
    shown_[c.instance].wrongs = c.choice.wrongs;
    if (draw_geometry(in, c, out)) continue;
    by_far_side.emplace_back(c.distance + in.scene->instances[c.instance].radius, &c);
  }
  sort_descending(by_far_side, [](const Ranked& ranked) { return ranked.first; });
  for (const auto& [far_side, candidate] : by_far_side) draw_candidate(in, *candidate, out);
  sort_for_blending(out.impostors, *in.scene, in.camera.pose.eye);
  return out;
}

}  // namespace mirage

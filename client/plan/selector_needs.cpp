// The part of the selector that decides what to ask for.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "client/hold/mesh_cache.h"
#include "client/hold/tile_cache.h"
#include "client/plan/eight_views.h"
#include "client/plan/frame_plan.h"
#include "client/plan/importance.h"
#include "client/plan/mesh_wants.h"
#include "client/plan/motion_need.h"
#include "client/plan/selector.h"
#include "client/plan/selector_input.h"
#include "client/plan/selector_rules.h"
#include "client/plan/tile_fit.h"
#include "client/plan/tile_need.h"
#include "client/price/ask_gain.h"
#include "client/price/tile_bytes.h"
#include "client/price/view_fit.h"
#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/base/order.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

constexpr double kViewGuard = 0.0873;  // 5 degrees around the predicted view
// Factor for what only the guard shows: it may never be seen.
constexpr double kGuardGain = 0.25;
constexpr double kUsualTileBytes = 0.15;  // bytes a texel, if nothing is known
constexpr double kQuantumShare = 0.01;    // 8-bit depth and the slope within a texel, in radii
// Share of tau that a tile errs by in the middle of its life.
constexpr double kGoodTileTau = 0.5;
// A tile of less than this part of the bytes of awaited geometry is asked for all the same.
constexpr double kHardlyDelays = 0.02;
// A tile replaces missing geometry if it lasts this long.
constexpr double kStandInLifeS = 3;
constexpr double kHardlyTurned = 0.04;      // radians
constexpr std::size_t kFewThings = 16;      // with more in view, each is small
constexpr double kLargeShare = 1.0 / 64;    // of the picture
constexpr double kRenewalShare = 0.5;       // of the bytes that the link has to spare
constexpr std::ptrdiff_t kFewMembers = 64;  // a group with as many members may be drawn one by one
constexpr double kStandsM = 1e-4;
constexpr double kJumpM = 0.05;            // distance beyond what the speed explains
constexpr long long kSettledUs = 100'000;  // a settled instance is looked at again after this time

ViewPlan plan_for(const SelectorInput& in, const InstanceView& view, const TileGroup& tiles,
                  const ViewGeometry& geometry, double tau_px) {
  ViewPlan plan;
  plan.tau_px = tau_px;
  plan.pixel_px = in.pixel_px;
  const glm::dquat inverse = glm::conjugate(glm::dquat(view.world_from_object.rotation));
  plan.velocity = inverse * (in.velocity - view.velocity) / double{view.world_from_object.scale};
  const bool flat = !in.method.automatic && in.method.method != DrawMethod::kDepth;
  const bool still = glm::length(in.velocity - view.velocity) < 0.02;
  if (flat || still) return plan;  // a quad serves a still eye best, and is cheapest
  double gap = kTypicalGap;
  if (!tiles.tiles.empty()) gap = tiles.tiles.back()->measure.depth_gap / geometry.radius;
  plan.depth_share = std::max(gap / hole_tolerance(tau_px, radius_px(geometry)), kQuantumShare);
  return plan;
}

void add_eight_view_need(const SelectorInput& in, std::uint32_t instance, const ViewGeometry& view,
                         const TileCache::LitGroup& lit, std::vector<TileNeed>& out) {
  const TileGroup none;
  std::optional<TileNeed> need =
      eight_view_need(lit.wanted ? *lit.tiles : none, view, radius_px(view));
  if (!need) return;
  need->instance = instance;
  need->light = in.cache->light();
  const double area = disc_px(in.predicted, radius_px(view));
  const Wrongs now = lit.tiles->tiles.empty() ? nothing_wrongs(area)
                                              : tile_wrongs(area, false, need->error_px, 1, 1);
  need->gain = ask_gain(area, now, tile_wrongs(area, false, 0, 1, 1), need->life_s);
  out.push_back(*need);
}

// True if a tile with two layers is wanted. That holds only with a fixed method of relief and a
// moving eye, and once a sharp tile of one layer is here, which arrives sooner. With the automatic
// choice of methods layers do not pay, because tiles are replaced before they are seen from far
// aside.
bool wants_layers(const SelectorInput& in, const ObjectDescription& object, const ViewPlan& plan,
                  double size_px, const TileFit& fit) {
  constexpr double kLeastPx = 64;  // smaller tiles take 1.8 times the bytes
  return !in.method.automatic && plan.depth_share != kFlatDepthShare && layered(object.needs) &&
         !object.group && size_px >= kLeastPx && fit.sharp(plan.tau_px, plan.pixel_px);
}

double walking_speed(const SelectorInput& in) {
  return std::max(glm::length(in.velocity), kWalkingMps);
}

// Returns the error with which the view tile shows the instance; nullopt: it does not.
std::optional<double> view_error_px(const SelectorInput& in, const InstanceView& instance,
                                    const ObjectDescription& object) {
  if (!in.view) return std::nullopt;
  return in.view->error_px(instance, object, in.predicted, in.time_s);
}

// Returns until when a tile that is good enough counts as settled. The eye may go a tenth of the
// way that is left to tau, at its speed or at least at a walk, within kSettledUs.
std::int64_t settled_until(const SelectorInput& in, const ObjectDescription& object,
                           const TileFit& fit, const ViewGeometry& view, const ViewPlan& plan) {
  if (object.track.moves()) return in.now_us;
  const double left = 1 - fit.error_px(plan.tau_px) / plan.tau_px;
  const double seconds = 0.1 * left * allowed_baseline(view, plan) / walking_speed(in);
  return in.now_us + std::min(std::llround(1e6 * std::clamp(seconds, 0.0, 1.0)), kSettledUs);
}

// Makes the need as coarse as the room in the atlas requires. Returns false if it is not to be
// asked for.
bool fit_to_atlas(const SelectorInput& in, TileCache::Room& room, TileNeed& need) {
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

// Returns the best resident tile, drawn with the methods that the plan is made for.
TileFit planned_fit(const SelectorInput& in, const TileGroup& group,
                    const ObjectDescription& object, const ViewGeometry& view,
                    const ViewPlan& plan) {
  if (group.tiles.empty()) return {};
  const bool still = plan.depth_share == kFlatDepthShare;
  return still && in.method.automatic ? best_flat(group, object, view, plan.tau_px)
                                      : best_fit(group, object, view, in.method, plan.tau_px);
}

std::uint8_t wanted_channels(const SelectorInput& in, std::uint32_t instance, const ViewPlan& plan,
                             double size, const TileFit& fit) {
  const ObjectDescription& object = in.scene->objects[in.scene->instances[instance].object];
  if (in.cache->wants_relit(instance)) return kRelitTile;
  return wants_layers(in, object, plan, size, fit) ? kLayeredTile : kLitTile;
}

// Returns the error of a thing without an image of its own.
Wrongs wrongs_without(double area, bool viewed) {
  return viewed ? view_wrongs(area) : nothing_wrongs(area);
}

// Returns the error of a tile that has just arrived.
Wrongs good_tile_wrongs(double area, bool tested, double tau, double size, const TileNeed& need) {
  const double texel_px = std::max(1.0, 2 * size / tile_edge(need.size_class));
  return tile_wrongs(area, tested, kGoodTileTau * tau, texel_px, 1);
}

}  // namespace

// Forgets what was settled if anything has changed beside time and an even walk.
void Selector::forget_settled(const SelectorInput& in) {
  Basis now;
  now.tau_px = in.tau_px;
  now.target_px = in.target_px;
  now.pixel_px = in.pixel_px;
  now.focal_px = in.predicted.focal_px();
  now.mesh_radii = in.mesh_radii;
  now.light = in.cache->light();
  now.automatic = in.method.automatic;
  now.eight_views = in.method.eight_views;
  now.method = in.method.method;
  now.eye = in.predicted.pose.eye;
  now.now_us = in.now_us;
  const double seconds = 1e-6 * static_cast<double>(now.now_us - basis_.now_us);
  const double way = glm::length(now.eye - basis_.eye);
  const bool jumped = !(way <= 2 * walking_speed(in) * seconds + kJumpM) || seconds < 0;
  // There may be no later frame to look again when a walk ends.
  now.moving = way > kStandsM;
  const bool stopped = basis_.moving && !now.moving;
  const bool same = now.tau_px == basis_.tau_px && now.target_px == basis_.target_px &&
                    now.pixel_px == basis_.pixel_px && now.focal_px == basis_.focal_px &&
                    now.mesh_radii == basis_.mesh_radii && now.light == basis_.light &&
                    now.automatic == basis_.automatic && now.eight_views == basis_.eight_views &&
                    now.method == basis_.method;
  basis_ = now;
  if (same && !jumped && !stopped) return;
  for (Shown& shown : shown_) shown.settled_until_us = INT64_MIN / 2;
}

// True if the last frame had no time for the instance's geometry, and there was no tile either.
bool Selector::shows_nothing(const SelectorInput& in, std::uint32_t instance) const {
  const Shown& shown = shown_[instance];
  return shown.frame == in.frame && !shown.as_mesh && !shown.tile &&
         in.cache->group_to_draw(instance)->tiles.empty();
}

// Looks after a thing whose tile will do, and that has no geometry. If it is in view and large, and
// few things are in view, it adds the need for a newer tile as soon as the line of sight has turned
// and the link has bytes to spare. Returns false if the thing may be left alone for a while.
bool Selector::renew(const SelectorInput& in, std::uint32_t instance, const ViewGeometry& view,
                     ViewPlan plan, const TileFit& fit, bool in_view, std::vector<TileNeed>& out) {
  note_strokes(in, instance, view, plan);
  const double size = radius_px(view), area = disc_px(in.predicted, size);
  const double picture = double{1} * in.predicted.width * in.predicted.height;
  if (!in_view || things_in_view() > kFewThings || area < kLargeShare * picture) return false;
  if (turned_since(*fit.tile, view) < kHardlyTurned) return true;
  // Keys are as far apart as tau allows; here they shall be no farther than what hardly shows.
  const double apart = 2 * kHardlyTurned * glm::length(view.eye) / allowed_baseline(view, plan);
  plan.tau_px *= std::clamp(apart, 0.05, 1.0);
  const ObjectDescription& object = in.scene->objects[in.scene->instances[instance].object];
  TileNeed need = need_for_view(view, plan);
  need.instance = instance;
  need.channels = wanted_channels(in, instance, plan, size, fit);
  need.light = in.cache->light();
  need.error_px = std::max(fit.error_px(plan.tau_px), unseen_px(*fit.tile, view));
  need.life_s = expected_life_s(view, plan);
  if (bytes_of(in, need) > kRenewalShare * in.spare_bytes) return true;
  const bool tested = object.needs & kNeedAlphaMask;
  const Wrongs shown = tile_wrongs(area, tested, need.error_px, fit.texel_px, 1);
  const Wrongs then = good_tile_wrongs(area, tested, plan.tau_px, size, need);
  need.gain = ask_gain(area, shown, then, need.life_s);
  out.push_back(need);
  return true;
}

void Selector::add_need(const SelectorInput& in, std::uint32_t instance, bool in_view,
                        std::vector<TileNeed>& out) {
  const InstanceView& view_of = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view_of.object];
  ViewGeometry view = view_geometry(in.predicted, view_of, object, in.time_s);
  const double size = radius_px(view);
  if (object.radius <= 0 || size < kMinRadiusPx || !outside(view)) return;
  const double distance = glm::length(view.eye) / view.radius;
  if (in.scene->geometry && object.surrounds) return;
  const double tau = allowed_px(in, in.predicted, view_of);
  const bool ready = (*in.mesh_ready)[view_of.object] && distance < swap_radii(in, object);
  const bool no_time = ready && shows_nothing(in, instance);
  const bool stand_in = ready && !no_time && !too_dear(in, in.predicted, instance, tau);
  if (stand_in && mesh_pays(in, in.predicted, instance, kGoodTileTau * tau)) return;
  const TileCache::LitGroup lit = in.cache->lit_group(instance);
  const TileGroup& group = *lit.tiles;
  if (faces_away(object, view.eye) || group.empty_from(view.eye)) return;  // under any light
  // The eye depth falls towards the edge of the view; ask as if the eye looked at the object.
  view.center_depth = glm::length(view.eye);
  if (in.method.eight_views) return add_eight_view_need(in, instance, view, lit, out);
  if (object.motion.moving()) return add_moving_needs(in, instance, view, tau, out);
  ViewPlan plan = plan_for(in, view_of, group, view, tau);
  if (stand_in) plan.depth_share = kFlatDepthShare;
  if (stand_in && expected_life_s(view, plan) < kStandInLifeS) return;
  const TileFit fit = planned_fit(in, group, object, view, plan);
  const double light_px = light_change_px(in, lit, instance, size);
  // A tile shaded by the client is right; the server's is better, and asked for in spare time.
  const bool shaded_here = !in.cache->wants_relit(instance) && fit.tile && fit.tile->relit;
  if (fit.settled(tau, in.pixel_px) && !is_stale(light_px, tau) && !shaded_here) {
    const bool watched = !ready && renew(in, instance, view, plan, fit, in_view, out);
    if (!watched && lit.wanted) {
      shown_[instance].settled_until_us = settled_until(in, object, fit, view, plan);
    }
    return;
  }
  // Inside the swap distance one tile serves as a stopgap until geometry arrives.
  if (distance < limits::kMinCaptureRadii && !group.tiles.empty()) return;
  TileNeed need = need_for_view(view, plan);
  if (stand_in && need.size_class >= kMaxAskedSizeClass) return;  // geometry is finer
  need.instance = instance;
  // The view tile may show an object without an image of its own.
  const auto view_px = group.tiles.empty() ? view_error_px(in, view_of, object) : std::nullopt;
  const bool unseen = group.tiles.empty() && !(view_px && *view_px <= kFirstImagePx * tau);
  // The first image is coarse and quick: a quarter of the edge takes a sixteenth of the bytes.
  if (unseen && in_view && !stand_in && !no_time) need.size_class = coarse_class(need.size_class);
  need.channels = wanted_channels(in, instance, plan, size, fit);
  need.first = in_view && group.tiles.empty() && !stand_in;
  need.light = in.cache->light();
  need.error_px = std::max(displayed_error_px(fit, size, tau), std::min(light_px, 2 * size));
  if (view_px) need.error_px = std::min(std::max(*view_px, tau), need.error_px);
  // Any image is better than none, however soon it ages.
  need.life_s = unseen ? kLongestLife : expected_life_s(view, plan);
  const bool tested = object.needs & kNeedAlphaMask;
  const double area = disc_px(in.predicted, size);
  Wrongs now = group.tiles.empty() ? wrongs_without(area, view_px.has_value())
                                   : tile_wrongs(area, tested, need.error_px, fit.texel_px, 1);
  if (stand_in && shown_[instance].frame == in.frame) now = shown_[instance].wrongs;
  need.gain = ask_gain(area, now, good_tile_wrongs(area, tested, tau, size, need), need.life_s);
  out.push_back(need);
}

double Selector::bytes_of(const SelectorInput& in, const TileNeed& need) {
  const double edge = tile_edge(need.size_class);
  return in.tile_bytes ? in.tile_bytes->expected(need.size_class, need.channels)
                       : kUsualTileBytes * edge * edge;
}

// Notes the bytes that the tiles of an instance cost, beside the price of its geometry.
void Selector::note_rent(const SelectorInput& in, const TileNeed& need) {
  const InstanceView& view_of = in.scene->instances[need.instance];
  const ObjectDescription& object = in.scene->objects[view_of.object];
  const double radii = glm::length(view_of.center - in.predicted.pose.eye) / view_of.radius;
  if (!in.meshes || !in.method.automatic || !in.scene->geometry || object.lods.empty()) return;
  if (object.group || radii >= swap_radii(in, object)) return;
  if (too_dear(in, in.predicted, need.instance, in.tau_px)) return;
  const double price =
      in.meshes->price_bytes(*in.scene, in.predicted, in.mesh_tau_px, need.instance);
  geometry_.want(view_of.object, {bytes_of(in, need), need.life_s, price, need.gain}, in.now_us);
}

// If the object consists of points and lines, notes its rent although its tile will do. Tiles show
// strokes about as wide as a pixel; geometry shows them as they are, at little cost.
void Selector::note_strokes(const SelectorInput& in, std::uint32_t instance,
                            const ViewGeometry& view, const ViewPlan& plan) {
  if (in.scene->objects[in.scene->instances[instance].object].triangles > 0) return;
  TileNeed tile = need_for_view(view, plan);
  tile.instance = instance;
  tile.gain = geometry_gain(in, instance);
  note_rent(in, tile);
}

// True if bought geometry comes instead of the tile. Something is shown meanwhile, or the geometry
// is worth more a byte and so comes first.
bool Selector::comes_soon(const SelectorInput& in, const TileNeed& need) const {
  const InstanceView& view_of = in.scene->instances[need.instance];
  const double radii = glm::length(view_of.center - in.predicted.pose.eye) / view_of.radius;
  if (!geometry_.bought(view_of.object, in.now_us)) return false;
  // While much is awaited, tiles are renewed: they hardly delay it.
  const double bytes = bytes_of(in, need);
  if (bytes < kHardlyDelays * geometry_.price(view_of.object)) return false;
  const double rank = need.gain / bytes;
  if (need.first && geometry_.worth_a_byte(view_of.object) < rank) return false;
  return radii < swap_radii(in, in.scene->objects[view_of.object]) &&
         !too_dear(in, in.predicted, need.instance, in.tau_px);
}

// True if the members are few, and all are drawn as geometry or will be: a tile of the group would
// only cost bytes.
bool Selector::members_are_geometry(const SelectorInput& in, std::uint32_t group) const {
  const SceneView::Members members = in.scene->members(group);
  if (members.empty() || members.end() - members.begin() > kFewMembers || !in.method.automatic)
    return false;
  return std::all_of(members.begin(), members.end(), [&](std::uint32_t member) {
    const InstanceView& view_of = in.scene->instances[member];
    const ObjectDescription& object = in.scene->objects[view_of.object];
    if (object.group) return members_are_geometry(in, member);
    const bool comes =
        (*in.mesh_ready)[view_of.object] || geometry_.bought(view_of.object, in.now_us);
    const double radii = glm::length(view_of.center - in.predicted.pose.eye) / view_of.radius;
    return comes && radii < swap_radii(in, object) &&
           !too_dear(in, in.predicted, member, in.tau_px);
  });
}

// True if the members of a group, or the parts of a cut instance, are wanted; false if it has none.
bool Selector::wants_members(const SelectorInput& in, std::uint32_t instance) const {
  const InstanceView& view_of = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view_of.object];
  const ViewGeometry view = view_geometry(in.predicted, view_of, object);
  // This is the rule for drawing: members of a group that stays would never be seen.
  const double slack = shown_[instance].frame == in.frame ? kMeshHysteresis : 1.0;
  if (object.cut) {
    const double radii = glm::length(view.eye) / view.radius;
    const bool known = !in.scene->members(instance).empty();
    return known && radii * slack < kPartRadii && !comes_as_mesh(in, object, radii);
  }
  if (!object.group) return false;
  return !group_wanted(in, view_of, view, allowed_px(in, in.predicted, view_of), slack) ||
         members_are_geometry(in, instance);
}

std::vector<TileNeed> Selector::needs(const SelectorInput& in) {
  std::vector<TileNeed> out;
  if (!in.method.automatic && in.method.method == DrawMethod::kMesh) return out;
  forget_settled(in);
  const Frustum frustum(in.predicted, kViewGuard), ahead(in.predicted), now(in.camera);
  const std::function<void(std::uint32_t)> visit = [&](std::uint32_t i) {
    const InstanceView& view_of = in.scene->instances[i];
    if (!frustum.may_see(view_of.center - in.predicted.pose.eye, view_of.radius)) return;
    if (in.now_us < shown_[i].settled_until_us) return;
    if (wants_members(in, i)) {
      for (const std::uint32_t member : in.scene->members(i)) visit(member);
      return;
    }
    const std::size_t first = out.size();
    const bool in_view = ahead.may_see(view_of.center - in.predicted.pose.eye, view_of.radius) ||
                         now.may_see(view_of.center - in.camera.pose.eye, view_of.radius);
    add_need(in, i, in_view, out);
    const double urgency = (in_view ? 1 : kGuardGain) / tolerance(view_of.importance);
    for (std::size_t k = first; k < out.size(); ++k) {
      note_rent(in, out[k]);
      out[k].gain *= urgency;
    }
  };
  in.scene->for_visible_roots(in.predicted, kViewGuard, visit);
  geometry_.decide(in.now_us, in.spare_bytes);
  out.erase(std::remove_if(out.begin(), out.end(),
                           [&](const TileNeed& need) { return comes_soon(in, need); }),
            out.end());
  sort_descending(out, [](const TileNeed& need) { return need.gain; });
  TileCache::Room room = in.cache->room(in.frame);
  out.erase(std::remove_if(out.begin(), out.end(),
                           [&](TileNeed& need) { return !fit_to_atlas(in, room, need); }),
            out.end());
  return out;
}

// Returns the gain of the instance's geometry over what it shows now.
double Selector::geometry_gain(const SelectorInput& in, std::uint32_t instance) const {
  const InstanceView& view_of = in.scene->instances[instance];
  const ObjectDescription& object = in.scene->objects[view_of.object];
  const double size = radius_px(view_geometry(in.predicted, view_of, object, in.time_s));
  const double area = disc_px(in.predicted, size);
  const Shown& shown = shown_[instance];
  const bool tested = object.needs & kNeedAlphaMask;
  const Wrongs now = shown.frame == in.frame ? shown_[instance].wrongs : nothing_wrongs(area);
  return ask_gain(area, now, mesh_wrongs(area, tested, 1, 1), kLongestLife);
}

MeshWants Selector::mesh_needs(const SelectorInput& in) {
  MeshWants out;
  in.scene->for_visible(in.predicted, kViewGuard, [&](std::uint32_t instance) {
    const InstanceView& view_of = in.scene->instances[instance];
    const ObjectDescription& object = in.scene->objects[view_of.object];
    const double radii = glm::length(view_of.center - in.predicted.pose.eye) / view_of.radius;
    geometry_.used(view_of.object, in.now_us);
    const bool bought = geometry_.bought(view_of.object, in.now_us) &&
                        radii < swap_radii(in, object) && !object.group;
    if (!bought && !comes_as_mesh(in, object, radii)) return;
    // Geometry may come first and still be too expensive to draw; tiles then stand beside it.
    if (!in.geometry_first && too_dear(in, in.predicted, instance, in.tau_px)) return;
    out.instances.push_back(instance);
    out.gain[view_of.object] += geometry_gain(in, instance);
  });
  // Bought geometry is worth at least the tiles that it replaces.
  for (auto& [object, gain] : out.gain) {
    if (geometry_.bought(object, in.now_us)) gain = std::max(gain, geometry_.worth(object));
  }
  return out;
}

}  // namespace mirage

#include "client/plan/motion_need.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/hold/tile_cache.h"
#include "client/plan/tile_fit.h"
#include "client/price/ask_gain.h"
#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/impostor/motion.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

constexpr double kMotionShare = 0.5;  // of tau, for the motion within a phase
constexpr int kFirstPhaseLevel = 2;   // quarters of the clip, until there is a tile
constexpr int kMaxPhasesAhead = 32;   // asked for at a time, per instance

// Returns the tiles of this phase. Coarse phases are among the fine ones, so a tile asked for at
// another distance is found as well.
TileGroup of_phase(const TileGroup& group, Phase phase) {
  TileGroup same;
  for (const TileRecordPtr& tile : group.tiles) {
    if (tile->phase == phase) same.tiles.push_back(tile);
  }
  return same;
}

Phase needed_phase(const MotionProfile& motion, double t, double distance) {
  return nearest_phase(t, motion.clip_s, phase_level_for(motion, t, distance));
}

/// Returns a coarse phase if its pose resembles that of time `t`, so that copies share it.
Phase first_phase(const MotionProfile& motion, double t, double radius, double distance) {
  const Phase coarse = nearest_phase(t, motion.clip_s, kFirstPhaseLevel);
  const double away = motion.travel(phase_time(coarse, motion.clip_s), t);
  return away <= radius && !motion.hides(coarse) ? coarse : needed_phase(motion, t, distance);
}

}  // namespace

void add_moving_needs(const SelectorInput& in, std::uint32_t instance, const ViewGeometry& view,
                      double tau_px, std::vector<TileNeed>& out) {
  const TileCache::LitGroup lit = in.cache->lit_group(instance);
  const TileGroup& group = *lit.tiles;
  const ObjectDescription& object = in.scene->objects[in.scene->instances[instance].object];
  const double size = radius_px(view);
  const bool first = group.tiles.empty();
  if (glm::length(view.eye) < limits::kMinCaptureRadii * view.radius && !first) return;
  ViewPlan plan;
  // The other half of tau is for the motion within the phase.
  plan.tau_px = (1 - kMotionShare) * tau_px;
  plan.pixel_px = in.pixel_px;
  const double allowed = kMotionShare * tau_px / motion_bound_px(view, 1.0);
  const double clip_s = object.motion.clip_s;
  const double step_s = clip_s / (1 << limits::kMaxPhaseLevel);
  // Before there is a tile, the first pose that shows something is asked for, however far ahead.
  const double end_s =
      first ? in.lead_s + clip_s : std::min(in.horizon_s, in.lead_s + clip_s - step_s);
  Phase last = kStaticPhase;
  int asked = 0;
  for (double ahead = in.lead_s; asked < kMaxPhasesAhead; ahead += step_s) {
    ViewGeometry then = view;
    then.clip_time_s = wrap_clip(view.clip_time_s + ahead, clip_s);
    if (object.motion.hidden_at(then.clip_time_s) && ahead <= end_s) continue;
    const Phase phase = first ? first_phase(object.motion, then.clip_time_s, view.radius, allowed)
                              : needed_phase(object.motion, then.clip_time_s, allowed);
    if (phase != last && !object.motion.hides(phase)) {
      last = phase;
      then.clip_time_s = phase_time(phase, clip_s);
      const TileFit fit = best_fit(of_phase(group, phase), object, then, in.method, tau_px);
      if (!fit.settled(plan.tau_px, in.pixel_px) || !lit.wanted) {
        TileNeed need = need_for_view(then, plan);
        need.instance = instance;
        need.phase = phase;
        need.first = first;
        need.channels = in.cache->wants_relit(instance) ? kRelitTile : kLitTile;
        need.light = in.cache->light();
        if (first) need.size_class = coarse_class(need.size_class);
        need.error_px = displayed_error_px(fit, size, tau_px);
        const double life =
            first ? kLongestLife
                  : clip_s / (1 << phase_level_for(object.motion, then.clip_time_s, allowed));
        need.life_s = std::min(life, kLongestLife);
        const double area = disc_px(in.predicted, size);
        const Wrongs now =
            first ? nothing_wrongs(area) : tile_wrongs(area, false, need.error_px, 1, 1);
        need.gain = ask_gain(area, now, tile_wrongs(area, false, tau_px, 1, 1), need.life_s);
        out.push_back(need);
        ++asked;
      }
    }
    if (ahead > end_s || (first && asked > 0)) return;
  }
}

}  // namespace mirage

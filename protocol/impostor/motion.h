#pragma once
// Speed and way of an animated object, and the phases at which its tiles are made (TECHNIQUES rows
// 18, 31). Times are in seconds; clip times lie in [0, clip_s), and the clip repeats.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace mirage {

struct Similarity;

/// Pose of a tile: 0 for static objects, else 1 + k for clip time k/256 of the clip. Phases of
/// coarser levels are a subset of the finer ones, so a tile asked for from far away also serves
/// near by.
using Phase = std::uint16_t;
inline constexpr Phase kStaticPhase = 0;

/// Speed profile of an object: for each of 64 equal parts of the clip, the largest speed any of its
/// vertices has there. A profile instead of one number lets still parts cost nothing. Jumps are
/// kept separately, because they have no speed: STEP keys, and a clip whose end differs from its
/// beginning.
struct MotionProfile {
  float clip_s = 0;          ///< 0: static
  std::vector<float> speed;  ///< limits::kMotionSegments when moving; object units per second
  std::vector<float> jump;   ///< summed per 1/256 of the clip, object units; empty: none
  float wrap_jump = 0;       ///< from the clip's end to its start, object units
  /// One bit for each of 256 poses, lowest first: 1: the pose has no extent, so that nothing shows.
  /// Empty: each has some. Meshes that are shown in turn are scaled to 0 in between.
  std::vector<std::uint8_t> hidden = {};

  bool moving() const { return clip_s > 0; }
  double max_speed() const;
  /// True if nothing shows at the pose of this phase, or at that nearest to clip time `t`.
  bool hides(Phase phase) const;
  bool hidden_at(double t) const;
  /// Returns an upper bound of the distance between any vertex at clip time `a` and at clip time
  /// `b`, the shorter way round the loop. It is 0 for static objects. A jump counts in full as soon
  /// as its part of the clip is touched.
  double travel(double a, double b) const;
  /// Returns the bound for all that lies on the way onward from clip time `from` to `to`, round the
  /// loop if `to` comes first.
  double travel_onward(double from, double to) const;

 private:
  double travel_forward(double from, double to) const;
};

/// The way of an object as a whole. Its poses, extents and images are relative to its place on the
/// way, so that a car that drives 200 m is as large as a car.
struct Track {
  float clip_s = 0;  ///< of the object's clip; 0: the object stays with its instance
  /// Places at equal times from the beginning of the clip to its end, limits::kTrackSteps + 1;
  /// object units. Straight lines in between.
  std::vector<glm::vec3> places = {};

  bool moves() const { return clip_s > 0; }
  /// Returns the place at a clip time from 0 to clip_s; 0 without a way.
  glm::dvec3 at(double clip_time_s) const;
};

/// Returns where an instance is at a clip time.
Similarity on_track(const Similarity& world_from_object, const Track& track, double clip_time_s);

/// Returns `time_s` wrapped into [0, clip_s), negative times included; 0 without a clip or a finite
/// time.
double wrap_clip(double time_s, double clip_s);

/// True if the phase fits the object: kStaticPhase for a static one, 1..256 for a moving one.
bool valid_phase(Phase phase, bool moving);
double phase_time(Phase phase, double clip_s);
/// Returns the phase of level `level` (2^level per clip) nearest to clip time `t`.
Phase nearest_phase(double t, double clip_s, int level);
/// Returns the coarsest level at which the pose of the nearest phase is within `distance` object
/// units of every pose near `t` with that phase; limits::kMaxPhaseLevel if no level is.
int phase_level_for(const MotionProfile& motion, double t, double distance);

/// Returns a deterministic offset in [0, clip_s) for copy `index` of an object, so that a crowd
/// does not move in step.
float copy_offset(std::uint32_t index, double clip_s);

}  // namespace mirage

#pragma once
// How fast a clip moves an object, and the phases its tiles are made at (TECHNIQUES rows 18, 31).
// Times are in seconds; clip times lie in [0, clip_s) and the clip repeats.

#include <cstdint>
#include <vector>

namespace mirage {

/// The object's own error per second: over each of 64 equal parts of the clip, the largest speed
/// any of its vertices has there. A profile instead of one number for the clip, so that still
/// parts cost nothing; with jumps apart, which have no speed (STEP keys, and a clip whose end is
/// not its beginning).
struct MotionProfile {
  float clip_s = 0;          ///< 0: static
  std::vector<float> speed;  ///< limits::kMotionSegments when moving; object units per second
  std::vector<float> jump;   ///< summed per 1/256 of the clip, object units; empty: none
  float wrap_jump = 0;       ///< from the clip's end to its start, object units

  bool moving() const { return clip_s > 0; }
  double max_speed() const;
  /// Upper bound of the distance between any vertex at clip time `a` and at clip time `b`, the
  /// shorter way round the loop. 0 for static objects; a jump counts whenever its part of the clip
  /// is met.
  double travel(double a, double b) const;

 private:
  double travel_forward(double from, double to) const;
};

/// `time_s` in [0, clip_s): the clip repeats, for negative times too. 0 when there is no clip or no
/// finite time.
double wrap_clip(double time_s, double clip_s);

/// A phase names a pose of a tile: 0 for static objects, else 1 + k, clip time k/256 of the clip.
/// Phases of coarser levels are a subset of the finer ones, so that a tile asked for from afar
/// serves near by, too.
using Phase = std::uint16_t;
inline constexpr Phase kStaticPhase = 0;

/// Fits the object: none for a static one, 1..256 for a moving one.
bool valid_phase(Phase phase, bool moving);
double phase_time(Phase phase, double clip_s);
/// The phase of level `level` (2^level a clip) nearest to clip time `t`.
Phase nearest_phase(double t, double clip_s, int level);
/// Coarsest level at which the pose of the nearest phase is within `distance` object units of
/// the pose at any time near `t` that has this phase; limits::kMaxPhaseLevel when none is.
int phase_level_for(const MotionProfile& motion, double t, double distance);

/// Deterministic offset in [0, clip_s) of copy `index` of an object, so that a crowd is not in
/// step.
float copy_offset(std::uint32_t index, double clip_s);

}  // namespace mirage

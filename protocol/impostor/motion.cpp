#include "protocol/impostor/motion.h"

#include <algorithm>
#include <cmath>

#include "protocol/base/limits.h"
#include "protocol/model/scene_types.h"

namespace mirage {
namespace {

constexpr int kPhases = 1 << limits::kMaxPhaseLevel;

}  // namespace

double MotionProfile::max_speed() const {
  return speed.empty() ? 0.0 : double{*std::max_element(speed.begin(), speed.end())};
}

bool MotionProfile::hides(Phase phase) const {
  if (hidden.empty() || phase == kStaticPhase) return false;
  const std::size_t pose = std::size_t{phase} - 1;
  return pose / 8 < hidden.size() && (hidden[pose / 8] >> pose % 8 & 1) != 0;
}

bool MotionProfile::hidden_at(double t) const {
  return !hidden.empty() && hides(nearest_phase(t, clip_s, limits::kMaxPhaseLevel));
}

double MotionProfile::travel_forward(double from, double to) const {
  const auto n = static_cast<double>(speed.size());
  const double part = clip_s / n;
  const auto last_part = static_cast<int>(speed.size()) - 1;
  const int first = std::clamp(static_cast<int>(from / part), 0, last_part);
  const int last = std::clamp(static_cast<int>(to / part), 0, last_part);
  double sum = 0;
  for (int i = first; i <= last; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double a = std::max(from, i * part), b = std::min(to, (i + 1) * part);
    sum += std::max(0.0, b - a) * speed[k];
  }
  if (jump.empty()) return sum;
  const double fine = clip_s / static_cast<double>(jump.size());
  const int most = static_cast<int>(jump.size()) - 1;
  const int end = std::clamp(static_cast<int>(to / fine), 0, most);
  for (int i = std::clamp(static_cast<int>(from / fine), 0, most); i <= end; ++i) {
    sum += jump[static_cast<std::size_t>(i)];
  }
  return sum;
}

double MotionProfile::travel(double a, double b) const {
  if (!moving() || speed.empty() || a == b) return 0;
  return std::min(travel_onward(a, b), travel_onward(b, a));
}

double MotionProfile::travel_onward(double from, double to) const {
  if (!moving() || speed.empty()) return 0;
  if (from <= to) return travel_forward(from, to);
  return travel_forward(from, clip_s) + wrap_jump + travel_forward(0, to);
}

glm::dvec3 Track::at(double clip_time_s) const {
  if (!moves() || places.size() < 2) return glm::dvec3(0);
  const auto steps = static_cast<double>(places.size() - 1);
  const double along = std::clamp(clip_time_s / double{clip_s}, 0.0, 1.0) * steps;
  const std::size_t step = std::min(static_cast<std::size_t>(along), places.size() - 2);
  return glm::mix(glm::dvec3(places[step]), glm::dvec3(places[step + 1]),
                  along - static_cast<double>(step));
}

Similarity on_track(const Similarity& world_from_object, const Track& track, double clip_time_s) {
  Similarity out = world_from_object;
  out.position += glm::dquat(out.rotation) * (double{out.scale} * track.at(clip_time_s));
  return out;
}

double wrap_clip(double time_s, double clip_s) {
  if (!(clip_s > 0) || !std::isfinite(time_s)) return 0;
  const double t = time_s - std::floor(time_s / clip_s) * clip_s;
  return t >= 0 && t < clip_s ? t : 0;  // rounding may reach the end
}

bool valid_phase(Phase phase, bool moving) {
  return moving ? phase >= 1 && phase <= kPhases : phase == kStaticPhase;
}

double phase_time(Phase phase, double clip_s) {
  return phase == kStaticPhase ? 0 : (phase - 1) * (clip_s / kPhases);
}

Phase nearest_phase(double t, double clip_s, int level) {
  if (!(clip_s > 0)) return kStaticPhase;
  const int count = 1 << std::clamp(level, 0, limits::kMaxPhaseLevel);
  const long nearest = std::lround(wrap_clip(t, clip_s) / clip_s * count) % count;
  return static_cast<Phase>(1 + nearest * (kPhases / count));
}

int phase_level_for(const MotionProfile& motion, double t, double distance) {
  for (int level = 0; level < limits::kMaxPhaseLevel; ++level) {
    const double half = 0.5 * motion.clip_s / (1 << level);
    const double pose = phase_time(nearest_phase(t, motion.clip_s, level), motion.clip_s);
    // All the way, for a pose in between may differ from both of its ends.
    const double before = motion.travel_onward(wrap_clip(pose - half, motion.clip_s), pose);
    const double after = motion.travel_onward(pose, wrap_clip(pose + half, motion.clip_s));
    if (std::max(before, after) <= distance) return level;
  }
  return limits::kMaxPhaseLevel;
}

float copy_offset(std::uint32_t index, double clip_s) {
  std::uint32_t h = index * 0x9e3779b9u;  // Fibonacci hashing spreads neighbours evenly
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  return static_cast<float>(static_cast<double>(h) / 4294967296.0 * clip_s);
}

}  // namespace mirage

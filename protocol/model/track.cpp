#include "protocol/model/track.h"

#include <algorithm>

namespace mirage {

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

}  // namespace mirage

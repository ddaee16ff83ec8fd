#pragma once
// The way of an object as a whole. Its poses, extents and images are relative to its place on the
// way, so that a car that drives 200 m is as large as a car.

#include <glm/glm.hpp>
#include <vector>

#include "protocol/model/scene_types.h"

namespace mirage {

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

}  // namespace mirage

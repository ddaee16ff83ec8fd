#pragma once
// Measures what a clip does to an object: its error per second, and bounds that enclose every pose.

#include <glm/glm.hpp>
#include <vector>

#include "protocol/animation.h"
#include "protocol/motion.h"

namespace mirage {

struct MeasuredMotion {
  MotionProfile motion;  ///< static when no vertex moves more than rounding does
  glm::vec3 box_min{0};
  glm::vec3 box_max{0};
  glm::vec3 center{0};
  double radius = 0;
  /// Their hull encloses every pose in the 26 directions of enclosing_hull().
  std::vector<glm::vec3> hull_points;
};

/// By brute force (TECHNIQUES row 18): the vertices that `indices` use, at 64 to 512 equal steps of
/// the clip and at every key. Between two neighbouring poses a path is taken to be at most twice as
/// long as it is straight, which holds while nothing turns by more than 217 degrees between them
/// (keys are at most 180 degrees apart, and are poses themselves); bounds grow by half of that, the
/// speeds by what neighbouring steps show.
MeasuredMotion measure_motion(const Mesh& mesh, const Animation& animation);

}  // namespace mirage

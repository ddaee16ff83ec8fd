#pragma once
// Measures what a clip does to an object: its error per second, and bounds that enclose every pose.

#include <glm/glm.hpp>
#include <vector>

#include "protocol/impostor/motion.h"
#include "protocol/model/animation.h"

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

/// By brute force (TECHNIQUES row 18): the vertices that `indices` use, at 64 to 256 equal steps of
/// the clip and at every key, each step halved until its halves agree in speed. Between two
/// neighbouring poses a path is taken to be at most twice as long as it is straight, which holds
/// while nothing turns by more than 217 degrees between them; bounds grow by half of that, speeds
/// by a margin.
MeasuredMotion measure_motion(const Mesh& mesh, const Animation& animation);

}  // namespace mirage

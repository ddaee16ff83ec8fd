#pragma once
// Measures the motion that a clip gives to an object: its error per second, and bounds that enclose
// every pose.

#include <glm/glm.hpp>
#include <vector>

#include "protocol/impostor/motion.h"
#include "protocol/model/animation.h"

namespace mirage {

struct MeasuredMotion {
  MotionProfile motion;  ///< static if no vertex moves more than rounding
  glm::vec3 box_min{0};
  glm::vec3 box_max{0};
  glm::vec3 center{0};
  double radius = 0;
  /// Points whose hull encloses every pose in the 26 directions of enclosing_hull().
  std::vector<glm::vec3> hull_points;
};

/// Measures by brute force (TECHNIQUES row 18). It poses the vertices that `indices` use at 64 to
/// 256 equal steps of the clip and at every key, and halves each step until its halves agree in
/// speed. Between neighbouring poses, a path is assumed to be at most twice as long as the straight
/// way. That holds while nothing turns by more than 217 degrees between them. Bounds grow by half
/// of that, speeds by a margin. Of more than 131,072 vertices that move rigidly, a body around the
/// vertices of each joint is measured.
/// `way`: length of the way that the poses are relative to (find_track.h); differences that are
/// rounding at that distance are no motion.
MeasuredMotion measure_motion(const Mesh& mesh, const Animation& animation, double way = 0);

}  // namespace mirage

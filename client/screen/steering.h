#pragma once
// Steering: how a person moves the eye. Looking turns it without tilting; moving goes where it
// looks.

#include <glm/glm.hpp>

#include "protocol/impostor/camera.h"

namespace mirage {

struct Steering {
  double yaw = 0;      ///< radians, to the right
  double pitch = 0;    ///< radians, downwards; the eye never looks steeper than 1.5
  glm::dvec3 move{0};  ///< m: right, up (of the world), ahead (where the eye looks)
};

/// Moves the pose. Numbers that are not finite leave it as it is.
void steer(Pose& pose, const Steering& by);

}  // namespace mirage

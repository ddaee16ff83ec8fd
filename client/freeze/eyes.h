#pragma once
// Eyes: the poses from which a freeze looks, in parts that can be made in any order.

#include <vector>

#include "client/freeze/options.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage {

/// The poses of one part, in order. A part is seen by a session of its own, so its files depend on
/// nothing else.
using EyePart = std::vector<Pose>;

/// Returns the camera of a freeze, without a pose.
Camera freeze_camera(const FreezeOptions& options);

/// Returns the parts. Around the scene, a part is a ring about the point that the home view looks
/// at, at its distance or at 0.6 of it. In a box, it is a place with twelve directions.
std::vector<EyePart> eye_parts(const FreezeOptions& options, const HomeView& home);

/// Returns poses between those of a part: where the error is larger than at the poses themselves.
EyePart between(const EyePart& part);

}  // namespace mirage

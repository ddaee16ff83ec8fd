#pragma once
// Finds the way that an object goes as a whole, and takes it out of its poses.

#include "server/scene/scene.h"

namespace mirage {

/// If the object's poses together reach at least twice as far as each alone, sets object.track to
/// the way of their middle, and makes the animation relative to it. Returns the length of the way's
/// box, object units: poses that differ by rounding at that distance are equal. 0: there is no way.
double take_track(SceneObject& object);

}  // namespace mirage

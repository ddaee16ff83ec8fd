#pragma once
// The ground of a scene, block by block, from the triangles of all that stands still. Recast, the
// navigation library of games, turns them into columns of solid and free space.

#include "protocol/base/result.h"
#include "protocol/model/ground.h"

namespace mirage {

struct PreparedScene;

/// Returns the floors of a block on which `body` can stand: with free space over and around them,
/// not steeper than 50 degrees, and not at an edge it would fall from. Leaves and other
/// alpha-tested surfaces are no obstacles, nor is what moves. Blended surfaces are solid: glass,
/// water. Error kResources: there is no memory for it.
Result<GroundBlock> make_ground(const PreparedScene& scene, const WalkBody& body, GroundBlockId id);

}  // namespace mirage

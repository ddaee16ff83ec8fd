#pragma once
// Objects whose surfaces lie against one another, such as a plate on a helmet. The stored depth of
// an impostor is coarse, so the farther of two such surfaces would cover the nearer one in stripes.
// The tiles of an object keep clear of the instances found here (touching_depth.h).

#include <cstdint>
#include <vector>

#include "protocol/impostor/object_proxy.h"
#include "server/prepare/grouping.h"
#include "server/scene/scene.h"

namespace mirage {

/// Finds, by object and then by group, the instances that matter to its tiles. A group's are the
/// ungrouped ones in whose box it stands, as far as they have no more triangles than its members:
/// they hide a part of it. An object's are those that its tiles keep clear of. Such an object
/// exists once and is neither moving, grouped, layered nor large scenery. Another instance counts
/// if it is not moving, if its box meets that of the object, and if it is at most twice as large:
/// the depth of a larger one is coarser yet, so the larger one's own tiles keep clear.
std::vector<Touching> find_touching(const Scene& scene,
                                    const std::vector<ObjectDescription>& objects,
                                    const Grouping& grouping);

}  // namespace mirage

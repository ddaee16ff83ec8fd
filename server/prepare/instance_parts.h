#pragma once
// Instances that may be shown as parts, and the parts as groups of one leaf.

#include "server/base/workers.h"
#include "server/prepare/grouping.h"

namespace mirage {

/// Cuts objects that an eye may come to be inside of: large relative to the scene, used once, still
/// and not blended. Adds the parts to `grouping`, marks the objects, and returns the parts' meshes
/// (InstanceGroup::part).
std::vector<Mesh> cut_instances(const Scene& scene, double bounds_radius,
                                std::vector<ObjectDescription>& objects, Grouping& grouping,
                                const Workers& workers);

}  // namespace mirage

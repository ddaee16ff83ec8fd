#pragma once
// Which instances may be shown as parts, and the parts as groups of one leaf.

#include "server/base/workers.h"
#include "server/prepare/grouping.h"

namespace mirage {

/// Cuts what is large against the scene, in it once, still and not blended: what an eye may come to
/// be in. Adds the parts to `grouping` and marks the objects; returns the parts' meshes
/// (InstanceGroup::part).
std::vector<Mesh> cut_instances(const Scene& scene, double bounds_radius,
                                std::vector<ObjectDescription>& objects, Grouping& grouping,
                                const Workers& workers);

}  // namespace mirage

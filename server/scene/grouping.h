#pragma once
// Impostor groups: all instances of a spatial cell as one object, for far views. The cells are the
// nodes of a tree that halves the longest side, so that a far view needs a few of them and a near
// one none.

#include <cstdint>
#include <vector>

#include "protocol/object_proxy.h"
#include "server/scene/scene.h"

namespace mirage {

inline constexpr std::uint32_t kNoGroup = 0xffffffffu;

/// One group. As an instance it sits at `center` without rotation or scale; its object space is
/// the world around that point.
struct InstanceGroup {
  glm::dvec3 center{0};
  std::vector<std::uint32_t> leaves;             ///< instances drawn in its image
  std::uint32_t parent = kNoGroup;               ///< index of the group it is nested in
  Importance importance = Importance::kScenery;  ///< largest of its leaves
};

struct Grouping {
  std::vector<InstanceGroup> groups;
  std::vector<std::uint32_t> group_of;  ///< by instance: the smallest group it is in, or kNoGroup
};

/// Groups the instances of `scene`. Left out: what surrounds the viewer, blended objects (one
/// alpha cannot order them), moving ones, and what is large against the scene. Few instances: no
/// groups.
Grouping group_instances(const Scene& scene, const std::vector<ObjectDescription>& objects);

/// Bounds, hull, mean colour and needs of a group, from those of its instances.
ObjectDescription describe_group(const InstanceGroup& group, const Scene& scene,
                                 const std::vector<ObjectDescription>& objects);

/// Marks the objects that surround the viewer (terrain, water, a room's shell): used once, large
/// against the scene, in a scene of several.
void find_surroundings(const Scene& scene, double bounds_radius,
                       std::vector<ObjectDescription>& objects);

}  // namespace mirage

#pragma once
// Impostor groups of a scene: the cells are the nodes of a tree that halves the longest side, so
// that a far view needs a few of them and a near one none.

#include <cstdint>
#include <vector>

#include "protocol/impostor/instance_group.h"
#include "server/scene/scene.h"

namespace mirage {

struct InstanceGroup {
  GroupBounds bounds;
  std::uint32_t first_leaf = 0, leaves = 0;  ///< instances in it: [first_leaf, first_leaf + leaves)
  std::uint32_t parent = kNoGroup;           ///< index of the group it is nested in
  std::uint32_t first_member = 0, members = 0;   ///< in Grouping::members
  Importance importance = Importance::kScenery;  ///< largest of its leaves
  /// Index into PreparedScene::parts: it shows a part of its one leaf. kNoGroup: all of its leaves.
  std::uint32_t part = kNoGroup;
};

/// An instance that may be shown as parts of it.
struct Cut {
  std::uint32_t instance = 0;
  std::uint32_t first_group = 0, groups = 0;  ///< its parts, in Grouping::groups
};

struct Grouping {
  std::vector<InstanceGroup> groups;    ///< a group comes before those nested in it
  std::vector<std::uint32_t> group_of;  ///< by instance: the smallest group it is in, or kNoGroup
  /// What groups consist of, group by group: instances, and groups as instance_count + their index.
  std::vector<std::uint32_t> members;
  std::vector<std::uint32_t> roots;  ///< the same of what is in no group
  std::vector<Cut> cuts;             ///< by instance, ascending; their parts are the last groups
};

/// Groups the instances of `scene` and puts them in the groups' order: what is in no group comes
/// first, in the order it had. Left out: what surrounds the viewer, blended objects (one
/// alpha cannot order them), moving ones, and what is large against the scene. Few instances: no
/// groups.
Grouping group_instances(Scene& scene, const std::vector<ObjectDescription>& objects);

/// All instances on their own.
Grouping no_groups(std::size_t instances);

/// Marks the objects that surround the viewer (terrain, water, a room's shell): used once, large
/// against the scene, in a scene of several; and those that are seen through and have other objects
/// in them (amber, a vitrine), which no picture of the object alone can show.
void find_surroundings(const Scene& scene, double bounds_radius,
                       std::vector<ObjectDescription>& objects);

}  // namespace mirage

#pragma once
// Impostor groups of a scene. The cells are nodes of a tree that halves the longest side, so that a
// far view needs a few of them and a near one none.

#include <cstdint>
#include <vector>

#include "protocol/impostor/instance_group.h"
#include "server/scene/scene.h"

namespace mirage {

struct InstanceGroup {
  GroupBounds bounds;
  std::uint32_t first_leaf = 0, leaves = 0;  ///< its instances: [first_leaf, first_leaf + leaves)
  std::uint32_t parent = kNoGroup;           ///< index of the group it is nested in
  std::uint32_t first_member = 0, members = 0;   ///< range in Grouping::members
  Importance importance = Importance::kScenery;  ///< largest importance of its leaves
  /// Index into PreparedScene::parts: the group shows a part of its only leaf. kNoGroup: it shows
  /// all of its leaves.
  std::uint32_t part = kNoGroup;
};

/// An instance that may be shown as parts.
struct Cut {
  std::uint32_t instance = 0;
  std::uint32_t first_group = 0, groups = 0;  ///< its parts, in Grouping::groups
};

struct Grouping {
  std::vector<InstanceGroup> groups;    ///< a group precedes its nested groups
  std::vector<std::uint32_t> group_of;  ///< by instance: its smallest group, or kNoGroup
  /// Members of the groups, group by group: instances, and groups as instance_count + their index.
  std::vector<std::uint32_t> members;
  std::vector<std::uint32_t> roots;  ///< members, numbered the same way, that are in no group
  std::vector<Cut> cuts;             ///< by instance, ascending; their parts are the last groups
};

/// The neighbours of an object or a group whose surfaces may lie against its own (touching.h).
struct Touching {
  std::uint32_t instance = 0;         ///< the object's only one; 0 for a group
  std::vector<std::uint32_t> others;  ///< instances of the scene, ascending; empty: nothing does
};

/// Groups the instances of `scene` and sorts them in the groups' order. Ungrouped instances come
/// first, in their earlier order. Not grouped: surroundings, blended objects (one alpha cannot
/// order them), moving ones, and those large relative to the scene. Scenes with few instances get
/// no groups.
Grouping group_instances(Scene& scene, const std::vector<ObjectDescription>& objects);

/// Returns a grouping without groups.
Grouping no_groups(std::size_t instances);

/// Marks the objects that surround the viewer. These are shells (terrain, water, a room's walls):
/// used once, large relative to the scene, in a scene of several. The others are see-through
/// objects with objects inside (amber, a vitrine), which no picture of the object alone can show.
void find_surroundings(const Scene& scene, double bounds_radius,
                       std::vector<ObjectDescription>& objects);

}  // namespace mirage

// Impostor groups: every eligible instance is in one tree, bounds enclose, and the result is always
// the same.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "server/prepare/prepared_scene.h"

namespace mirage {
namespace {

std::shared_ptr<const PreparedScene> forest() {
  static const std::shared_ptr<const PreparedScene> scene =
      load_scene("builtin:forest?trees=120").take();
  return scene;
}

// Returns the number of groups of instances; the parts of one follow them.
std::size_t groups_of(const PreparedScene& scene) {
  const Grouping& grouping = scene.grouping;
  return grouping.cuts.empty() ? grouping.groups.size() : grouping.cuts.front().first_group;
}

TEST(ServerGrouping, EveryInstanceIsInAtMostOneTree) {
  const PreparedScene& scene = *forest();
  const Grouping& grouping = scene.grouping;
  ASSERT_FALSE(grouping.groups.empty());
  std::map<std::uint32_t, std::set<std::uint32_t>> roots;
  std::size_t grouped = 0;
  for (std::uint32_t i = 0; i < scene.scene.instances.size(); ++i) {
    std::uint32_t group = grouping.group_of[i];
    const ObjectDescription& object = scene.objects[scene.scene.instances[i].object];
    if (group == kNoGroup) continue;
    ++grouped;
    EXPECT_FALSE(object.surrounds);
    EXPECT_FALSE(object.needs & kNeedBlend);
    int depth = 0;
    for (; group != kNoGroup; group = grouping.groups[group].parent) {
      const InstanceGroup& of = grouping.groups[group];
      EXPECT_GE(i, of.first_leaf);
      EXPECT_LT(i, of.first_leaf + of.leaves);
      ASSERT_LT(++depth, 8);
    }
  }
  EXPECT_GT(grouped, scene.scene.instances.size() / 2);
}

// Two glass boxes: something stands in one of them, and only beside the other.
TEST(ServerGrouping, WhatIsSeenThroughAndHoldsSomethingIsGeometry) {
  Scene scene;
  std::vector<ObjectDescription> objects(3);
  for (ObjectDescription& object : objects) {
    object.radius = 1;
    object.box_min = glm::vec3(-0.5f);
    object.box_max = glm::vec3(0.5f);
    object.triangles = 12;
  }
  objects[0].needs = objects[1].needs = kNeedBlend;
  scene.materials.resize(1);
  scene.materials[0].alpha_mode = AlphaMode::kBlend;
  scene.materials[0].base_color.a = 0.4f;
  scene.objects.resize(3);
  for (SceneObject& object : scene.objects) object.mesh.primitives.resize(1);
  scene.instances.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) scene.instances[i].object = i;
  scene.instances[1].world_from_object.position = {5, 0, 0};
  scene.instances[1].world_from_object.scale = 2;
  const auto holds = [&](const glm::dvec3& thing) {
    std::vector<ObjectDescription> found = objects;
    scene.instances[2].world_from_object.position = thing;
    find_surroundings(scene, 10, found);
    EXPECT_FALSE(found[2].surrounds) << "nobody sees through it";
    return std::pair(found[0].surrounds, found[1].surrounds);
  };
  EXPECT_EQ(holds({0.3, 0, 0.2}), std::pair(true, false));
  EXPECT_EQ(holds({0.6, 0, 0}), std::pair(false, false)) << "beside the first";
  EXPECT_EQ(holds({5.9, 0, 0}), std::pair(false, true)) << "the second is twice as large";
  scene.materials[0].base_color.a = 1;
  EXPECT_EQ(holds({0.3, 0, 0.2}), std::pair(false, false)) << "leaves, not glass";
  scene.materials[0].base_color.a = 0.4f;
  objects[0].triangles = 100'000'000;
  EXPECT_EQ(holds({0.3, 0, 0.2}), std::pair(false, false)) << "too much to be sent first of all";
}

TEST(ServerGrouping, BoundsEncloseTheMembersVertices) {
  const PreparedScene& scene = *forest();
  for (std::size_t g = 0; g < groups_of(scene); g += 3) {
    const InstanceGroup& group = scene.grouping.groups[g];
    const ObjectDescription of = *scene.description(scene.scene.objects.size() + g);
    EXPECT_TRUE(of.group);
    EXPECT_EQ(of.hull.parallax.size(), of.hull.vertices.size());
    for (std::uint32_t i = group.first_leaf; i < group.first_leaf + group.leaves; ++i) {
      const Instance& instance = scene.scene.instances[i];
      const Similarity& m = instance.world_from_object;
      for (const Vertex& v : scene.scene.objects[instance.object].mesh.vertices) {
        const glm::dvec3 p = m.position - group.bounds.center +
                             glm::dquat(m.rotation) * (glm::dvec3(v.position) * double{m.scale});
        ASSERT_LE(glm::length(p), of.radius);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_GE(p[axis], of.box_min[axis]);
          ASSERT_LE(p[axis], of.box_max[axis]);
        }
      }
    }
  }
}

TEST(ServerGrouping, GroupsAreInstancesAfterTheScenesOwn) {
  const PreparedScene& scene = *forest();
  const std::size_t own = scene.scene.instances.size();
  ASSERT_EQ(scene.instance_count(), own + scene.grouping.groups.size());
  for (std::size_t g = 0; g < groups_of(scene); ++g) {
    const Instance instance = scene.instance(own + g);
    EXPECT_EQ(instance.object, scene.scene.objects.size() + g);
    EXPECT_EQ(instance.world_from_object.position, scene.grouping.groups[g].bounds.center);
    EXPECT_TRUE(scene.description(instance.object)->group);
    EXPECT_EQ(scene.group(instance.object), &scene.grouping.groups[g]);
    const std::uint32_t parent = scene.parent(own + g);
    if (parent != kNoGroup) {
      EXPECT_TRUE(scene.group_of_instance(parent));
      EXPECT_LT(parent, own + g) << "a group comes before those nested in it";
    }
  }
  EXPECT_EQ(scene.group(0), nullptr);
}

TEST(ServerGrouping, AGroupIsAsImportantAsItsMostImportantMember) {
  Scene scene = forest()->scene;
  for (Instance& instance : scene.instances) instance.importance = Importance::kScenery;
  const std::uint32_t one = forest()->grouping.groups[groups_of(*forest()) - 1].first_leaf;
  scene.instances[one].importance = Importance::kImportant;
  PreparedScene prepared;
  prepared.grouping = group_instances(scene, forest()->objects);
  prepared.scene = std::move(scene);
  std::size_t important = 0;
  for (std::size_t g = 0; g < prepared.grouping.groups.size(); ++g) {
    const InstanceGroup& group = prepared.grouping.groups[g];
    const bool has_it = one >= group.first_leaf && one < group.first_leaf + group.leaves;
    const Importance expected = has_it ? Importance::kImportant : Importance::kScenery;
    EXPECT_EQ(prepared.instance(prepared.scene.instances.size() + g).importance, expected);
    important += has_it ? 1 : 0;
  }
  EXPECT_GE(important, 1u);
  EXPECT_LT(important, prepared.grouping.groups.size());
}

TEST(ServerGrouping, TheSameEveryTime) {
  const auto again = load_scene("builtin:forest?trees=120").take();
  ASSERT_EQ(again->grouping.groups.size(), forest()->grouping.groups.size());
  EXPECT_EQ(again->grouping.group_of, forest()->grouping.group_of);
}

TEST(ServerGrouping, FewInstancesAreNotGrouped) {
  EXPECT_EQ(groups_of(*load_scene("builtin:knot").take()), 0u);
}

TEST(ServerGrouping, MembersAndRootsAreEverythingOnce) {
  const PreparedScene& scene = *forest();
  std::set<std::uint32_t> seen;
  const auto see = [&](std::uint32_t id, std::uint32_t parent) {
    EXPECT_TRUE(seen.insert(id).second);
    EXPECT_EQ(scene.parent(id), parent);
  };
  for (const std::uint32_t id : scene.grouping.roots) see(id, kNoGroup);
  const std::size_t own = scene.scene.instances.size();
  for (std::size_t g = 0; g < groups_of(scene); ++g) {
    const InstanceGroup& group = scene.grouping.groups[g];
    EXPECT_GE(group.members, 2u);
    for (std::uint32_t i = 0; i < group.members; ++i) {
      see(scene.grouping.members[group.first_member + i], static_cast<std::uint32_t>(own + g));
    }
  }
  for (const Cut& cut : scene.grouping.cuts) {
    for (const std::uint32_t id : scene.members(cut.instance)) see(id, cut.instance);
  }
  EXPECT_EQ(seen.size(), scene.instance_count());
}

TEST(ServerGrouping, InALargeSceneTooTheSmallestAreSmallAndTheLargestMany) {
  const auto field = load_scene("builtin:field?instances=100000").take();
  std::uint32_t smallest = UINT32_MAX, largest = 0;
  for (const InstanceGroup& group : field->grouping.groups) {
    smallest = std::min(smallest, group.leaves);
    largest = std::max(largest, group.leaves);
  }
  EXPECT_LE(smallest, 4u);
  EXPECT_GE(largest, 512u);
  EXPECT_LT(field->grouping.roots.size(), 300u) << "the part that every client is told of";
}

}  // namespace
}  // namespace mirage

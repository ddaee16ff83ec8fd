// Impostor groups: every eligible instance in one tree, bounds that enclose, the same every time.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "server/scene/prepared_scene.h"

namespace mirage {
namespace {

std::shared_ptr<const PreparedScene> forest() {
  static const std::shared_ptr<const PreparedScene> scene =
      load_scene("builtin:forest?trees=120").take();
  return scene;
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
      const auto& leaves = grouping.groups[group].leaves;
      EXPECT_EQ(std::count(leaves.begin(), leaves.end(), i), 1);
      ASSERT_LT(++depth, 8);
    }
  }
  EXPECT_GT(grouped, scene.scene.instances.size() / 2);
}

TEST(ServerGrouping, BoundsEncloseTheMembersVertices) {
  const PreparedScene& scene = *forest();
  for (std::size_t g = 0; g < scene.grouping.groups.size(); g += 3) {
    const InstanceGroup& group = scene.grouping.groups[g];
    const ObjectDescription& of = scene.objects[scene.scene.objects.size() + g];
    EXPECT_TRUE(of.group);
    EXPECT_EQ(of.hull.parallax.size(), of.hull.vertices.size()) << "clients refuse anything else";
    for (const std::uint32_t i : group.leaves) {
      const Instance& instance = scene.scene.instances[i];
      const Similarity& m = instance.world_from_object;
      for (const Vertex& v : scene.scene.objects[instance.object].mesh.vertices) {
        const glm::dvec3 p = m.position - group.center +
                             glm::dquat(m.rotation) * (glm::dvec3(v.position) * double{m.scale});
        ASSERT_LE(glm::length(p), of.radius);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_GE(p[axis], of.box_min[axis] - 1e-4);
          ASSERT_LE(p[axis], of.box_max[axis] + 1e-4);
        }
      }
    }
  }
}

TEST(ServerGrouping, GroupsAreInstancesAfterTheScenesOwn) {
  const PreparedScene& scene = *forest();
  const std::size_t own = scene.scene.instances.size();
  ASSERT_EQ(scene.instance_count(), own + scene.grouping.groups.size());
  for (std::size_t g = 0; g < scene.grouping.groups.size(); ++g) {
    const Instance instance = scene.instance(own + g);
    EXPECT_EQ(instance.object, scene.scene.objects.size() + g);
    EXPECT_EQ(instance.world_from_object.position, scene.grouping.groups[g].center);
    EXPECT_TRUE(scene.objects[instance.object].group);
    EXPECT_EQ(scene.group(instance.object), &scene.grouping.groups[g]);
    const std::uint32_t parent = scene.parent(own + g);
    if (parent != kNoGroup) {
      EXPECT_TRUE(scene.objects[scene.instance(parent).object].group);
    }
  }
  EXPECT_EQ(scene.group(0), nullptr);
}

TEST(ServerGrouping, AGroupIsAsImportantAsItsMostImportantMember) {
  Scene scene = forest()->scene;
  for (Instance& instance : scene.instances) instance.importance = Importance::kScenery;
  const std::uint32_t one = forest()->grouping.groups.back().leaves.front();
  scene.instances[one].importance = Importance::kImportant;
  PreparedScene prepared;
  prepared.grouping = group_instances(scene, forest()->objects);
  prepared.scene = std::move(scene);
  std::size_t important = 0;
  for (std::size_t g = 0; g < prepared.grouping.groups.size(); ++g) {
    const auto& leaves = prepared.grouping.groups[g].leaves;
    const bool has_it = std::count(leaves.begin(), leaves.end(), one) > 0;
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
  EXPECT_TRUE(load_scene("builtin:knot").take()->grouping.groups.empty());
}

TEST(ServerGrouping, DescriptionOfALargeSceneStaysSmall) {
  const auto field = load_scene("builtin:field?instances=20000").take();
  EXPECT_GT(field->grouping.groups.size(), 100u);
  EXPECT_LT(field->grouping.groups.size(), 6000u);
}

}  // namespace
}  // namespace mirage

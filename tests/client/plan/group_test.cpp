// Impostor groups on the client: one image for many far instances, and members again when near.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kNone = InstanceView::kNoParent;

// Object 0: a ball of radius 1. Instances 0..3 in group 4, of radius 8.
SceneView grouped(std::uint32_t parent_of_group = kNone, std::uint32_t parent = 4) {
  std::vector<Placed> placed;
  for (int i = 0; i < 4; ++i) placed.push_back({{4.0 * i - 6, 0, 0}, 1, 0, parent});
  return make_scene(placed, {}, {{{0, 0, 0}, 8.0f, parent_of_group, 0, 4}});
}

struct GroupWorld : SelectorWorld {
  GroupWorld() : SelectorWorld(grouped()) {}
  void look_from(double distance) { look({0, 0, distance}, {0, 0, 0}); }
  std::vector<std::uint32_t> drawn() {
    std::vector<std::uint32_t> out;
    for (const DrawnImpostor& d : only_select(input()).impostors) out.push_back(d.instance);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());  // two entries while a tile fades in
    return out;
  }
  std::vector<std::uint32_t> needed() {
    std::vector<std::uint32_t> out;
    for (const TileNeed& need : selector.needs(input())) out.push_back(need.instance);
    std::sort(out.begin(), out.end());
    return out;
  }
  void pass(std::int64_t us) {
    now_us += us;
    ++frame;
  }
};

using Indices = std::vector<std::uint32_t>;

TEST(CoreGroup, FarTheGroupIsAskedForNearItsMembers) {
  GroupWorld world;
  world.look_from(300);
  EXPECT_EQ(world.needed(), Indices{4});
  world.look_from(20);
  EXPECT_EQ(world.needed(), (Indices{0, 1, 2, 3}));
}

TEST(CoreGroup, OneImageStandsForItsMembers) {
  GroupWorld world;
  world.look_from(300);
  ASSERT_TRUE(world.add_tile(4));
  const DrawList list = world.select(world.input());
  ASSERT_EQ(list.impostors.size(), 1u);
  EXPECT_EQ(list.impostors[0].instance, 4u);
  EXPECT_EQ(list.visible, 1u) << "the cost follows what can be told apart";
  EXPECT_TRUE(list.placeholders.empty());
  EXPECT_TRUE(world.needed().empty());
}

TEST(CoreGroup, WithoutItsImageTheMembersAreDrawn) {
  GroupWorld world;
  world.look_from(300);
  EXPECT_EQ(world.select(world.input()).placeholders.size(), 4u);
  for (std::uint32_t i = 0; i < 4; ++i) ASSERT_TRUE(world.add_tile(i));
  EXPECT_EQ(world.drawn(), (Indices{0, 1, 2, 3}));
}

TEST(CoreGroup, TheGroupFadesInOverItsMembersAndTheyOverIt) {
  GroupWorld world;
  world.look_from(300);
  for (std::uint32_t i = 0; i < 4; ++i) ASSERT_TRUE(world.add_tile(i));
  world.drawn();
  world.pass(50'000);
  ASSERT_TRUE(world.add_tile(4));
  EXPECT_EQ(world.drawn(), (Indices{0, 1, 2, 3, 4})) << "members stay underneath";
  world.pass(60'000);
  for (const DrawnImpostor& d : world.select(world.input()).impostors) {
    EXPECT_NEAR(d.fade, d.instance == 4 ? 0.5f : 1.0f, 1e-3f);
  }
  world.pass(70'000);
  EXPECT_EQ(world.drawn(), Indices{4});
  world.look_from(20);
  for (std::uint32_t i = 0; i < 4; ++i) ASSERT_TRUE(world.add_tile(i));
  world.pass(10'000);
  EXPECT_EQ(world.drawn(), (Indices{0, 1, 2, 3, 4}));
  world.pass(60'000);
  for (const DrawnImpostor& d : world.select(world.input()).impostors) {
    EXPECT_NEAR(d.fade, d.instance == 4 ? 1.0f : 0.5f, 1e-3f);
  }
  world.pass(70'000);
  EXPECT_EQ(world.drawn(), (Indices{0, 1, 2, 3}));
}

// Geometry of members is as good as tiles: a group's image fades in over it, instead of replacing
// it at once.
TEST(CoreGroup, TheGroupFadesInOverGeometry) {
  GroupWorld world;
  world.mesh_ready[0] = true;
  const auto select = [&world] {
    SelectorInput in = world.input();
    in.mesh_radii = 1000;
    return world.select(in);
  };
  world.look_from(300);
  EXPECT_EQ(select().meshes.size(), 4u);
  world.pass(50'000);
  ASSERT_TRUE(world.add_tile(4));
  EXPECT_EQ(select().meshes.size(), 4u) << "members stay underneath";
  world.pass(60'000);
  const DrawList half = select();
  ASSERT_EQ(half.impostors.size(), 1u);
  EXPECT_NEAR(half.impostors[0].fade, 0.5f, 1e-3f);
  world.pass(70'000);
  EXPECT_TRUE(select().meshes.empty());
}

// A drawn group stays until a little nearer than an undrawn one would be taken. Until then its
// members are not asked for.
TEST(CoreGroup, MembersOfAGroupThatGoesOnAreNotAskedFor) {
  GroupWorld world;
  double nearest = 300;  // nearest distance at which the group is asked for, not its members
  for (double d = 300; d > 20; d -= 1) {
    world.look_from(d);
    if (world.needed() != Indices{4}) break;
    nearest = d;
  }
  world.look_from(1.05 * nearest);
  ASSERT_TRUE(world.add_tile(4));
  EXPECT_EQ(world.drawn(), Indices{4});
  world.pass(10'000);
  world.look_from(0.97 * nearest);
  EXPECT_EQ(world.drawn(), Indices{4});
  for (const std::uint32_t instance : world.needed()) EXPECT_EQ(instance, 4u);
  world.pass(10'000);
  world.look_from(0.8 * nearest);
  world.drawn();
  EXPECT_EQ(world.needed(), (Indices{0, 1, 2, 3}));
}

TEST(CoreGroup, CirclesAndUnknownParentsAreRefused) {
  EXPECT_EQ(grouped().instances.size(), 5u);
  EXPECT_TRUE(grouped(4).instances.empty()) << "a group in itself";
  EXPECT_TRUE(grouped(kNone, 17).instances.empty());
  EXPECT_TRUE(grouped(kNone, 1).instances.empty()) << "the parent is no group";
}

}  // namespace
}  // namespace mirage::test

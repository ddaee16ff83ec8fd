// Parts: an eye inside a mesh that is not sent. Its parts are asked for and drawn until the eye
// leaves.
#include <gtest/gtest.h>

#include "client/plan/scene_opener.h"
#include "protocol/impostor/tile_key.h"
#include "server/prepare/prepared_scene.h"
#include "tests/support/room.h"
#include "tests/support/told_scene.h"

namespace mirage::test {
namespace {

std::shared_ptr<const PreparedScene> room() {
  static const auto scene = prepare_scene(room_scene()).take();
  return scene;
}

SelectorWorld inside(bool geometry = false) {
  SelectorWorld world(as_told(*room(), geometry));
  world.look(room()->scene.home.eye, room()->scene.home.target);
  return world;
}

bool open_up(SelectorWorld& world) {
  SceneOpener opener;
  world.now_us += 200'000;
  const std::vector<wire::OpenRequestT> requests = opener.plan({world.input()});
  if (requests.empty()) return false;
  EXPECT_TRUE(take(world.scene, pages_of({*room(), requests.front()})).ok());
  world.selector.grow(world.scene);
  world.cache.grow(world.scene);
  world.mesh_ready.resize(world.scene.objects.size(), false);
  return true;
}

TEST(CoreParts, AreNotToldUnasked) {
  const SelectorWorld world = inside();
  EXPECT_TRUE(world.scene.complete());
  EXPECT_EQ(world.scene.instances.size(), 1u);
  EXPECT_FALSE(world.scene.opened(0));
}

TEST(CoreParts, AreAskedForFromInsideAndThenDrawn) {
  SelectorWorld world = inside();
  EXPECT_TRUE(world.selector.needs(world.input()).empty()) << "no tile of the whole can be had";
  ASSERT_TRUE(open_up(world));
  EXPECT_TRUE(world.scene.opened(0));
  const std::vector<TileNeed> needs = world.selector.needs(world.input());
  EXPECT_GT(needs.size(), 30u);
  for (const TileNeed& need : needs) {
    EXPECT_EQ(world.scene.instances[need.instance].parent, 0u);
    world.add_tile(need.instance);
  }
  const DrawList drawn = world.select(world.input());
  EXPECT_GT(drawn.impostors.size(), needs.size() / 2);
  for (const DrawnImpostor& one : drawn.impostors) EXPECT_NE(one.instance, 0u);
}

TEST(CoreParts, AreNotAskedForFromFarOrWhereGeometryComes) {
  SelectorWorld far = inside();
  far.look({0, 0, 30}, {0, 0, 0});
  EXPECT_FALSE(open_up(far));
  SelectorWorld served = inside(true);
  EXPECT_FALSE(open_up(served));
}

TEST(CoreParts, GiveWayToTheWholeFromFarAway) {
  SelectorWorld world = inside();
  ASSERT_TRUE(open_up(world));
  world.look({0, 0, 30}, {0, 0, 0});
  const std::vector<TileNeed> needs = world.selector.needs(world.input());
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_EQ(needs[0].instance, 0u);
  world.add_tile(0);
  const DrawList drawn = world.select(world.input());
  ASSERT_EQ(drawn.impostors.size(), 1u);
  EXPECT_EQ(drawn.impostors[0].instance, 0u);
}

// One of both is always drawn: the tile of the whole stays from the frame in which the eye comes
// near until the parts have images.
TEST(CoreParts, TheWholeStaysUntilPartsHaveImages) {
  SelectorWorld world = inside();
  ASSERT_TRUE(open_up(world));
  const double near = 1.25 * world.scene.instances[0].radius;
  world.look({0, 0, near}, {0, 0, 0});
  world.add_tile(0);
  DrawList drawn = world.select(world.input());
  ASSERT_EQ(drawn.impostors.size(), 1u);
  EXPECT_EQ(drawn.impostors[0].instance, 0u);
  for (const std::uint32_t part : world.scene.members(0)) world.add_tile(part);
  world.frame += 1;
  world.now_us += 1'000'000;
  world.select(world.input());
  world.frame += 1;
  world.now_us += 1'000'000;
  drawn = world.select(world.input());
  EXPECT_GT(drawn.impostors.size(), 50u);
  for (const DrawnImpostor& one : drawn.impostors) EXPECT_NE(one.instance, 0u);
}

TEST(CoreParts, OfAnInstanceThatIsWholeAreRefused) {
  SceneOptions options;
  SceneView scene = make_scene({{{0, 0, 0}}}, options, {PlacedGroup{{9, 9, 9}, 1}});
  ASSERT_TRUE(scene.complete());
  wire::InstancePageT page;
  page.request_id = 1;
  page.groups.push_back(group_record({{0, 0, 0}, 0.1f, 0, 0, 1}, 1, 0));
  page.opened.push_back(0);
  const Result<void> taken = scene.accept(page);
  ASSERT_FALSE(taken.ok());
  EXPECT_EQ(taken.error().id, ErrorId::kWireState);
}

}  // namespace
}  // namespace mirage::test

// Ground: where somebody who walks may stand.
#include "server/ground/ground.h"

#include <gtest/gtest.h>

#include "client/scene/ground_map.h"
#include "protocol/codec/ground_codec.h"
#include "server/prepare/prepared_scene.h"
#include "tests/support/boxes.h"

namespace mirage::test {
namespace {

constexpr WalkBody kPerson{1.7};

/// A floor of 40 m x 40 m whose top is at 0, and boxes on it: half extents and middle.
struct Box {
  glm::vec3 half;
  glm::dvec3 middle;
};
std::shared_ptr<const PreparedScene> floor_with(const std::vector<Box>& boxes) {
  std::vector<SceneObject> objects = {box({20, 0.5f, 20})};
  PlacedObjects placed = {{0, {0, -0.5, 0}}};
  for (const Box& one : boxes) {
    placed.push_back({static_cast<std::uint32_t>(objects.size()), one.middle});
    objects.push_back(box(one.half));
  }
  return *prepare_scene(placed_scene(std::move(objects), placed));
}

/// Returns the ground within a block of the origin, as a client gets it.
GroundMap ground_of(const PreparedScene& scene) {
  GroundMap map;
  map.reset(kPerson);
  for (const GroundBlockId& id : map.missing_around(0, 0)) {
    Result<GroundBlock> made = make_ground(scene, kPerson, id);
    EXPECT_TRUE(made.ok());
    Result<GroundBlock> told = decode_ground(encode_ground(*made), ground_bytes(*made));
    EXPECT_TRUE(told.ok());
    told->id = id;
    map.add(told.take());
  }
  return map;
}

std::optional<double> floor_at(const GroundMap& map, double x, double z) {
  return map.floor_below(x, z, 100);
}

TEST(ServerGround, AFloorIsWhereItIs) {
  const GroundMap map = ground_of(*floor_with({}));
  for (const auto& [x, z] : {std::pair{0.1, 0.1}, {-7.0, 9.0}, {12.0, -3.0}}) {
    ASSERT_TRUE(floor_at(map, x, z)) << x << ' ' << z;
    EXPECT_GE(*floor_at(map, x, z), 0);
    EXPECT_LE(*floor_at(map, x, z), 0.06) << "a step of the code above, at most";
  }
}

TEST(ServerGround, NobodyStandsInAWallOrTooNearToIt) {
  const GroundMap map = ground_of(*floor_with({{{4, 1.5f, 0.1f}, {0, 1.5, -2}}}));
  EXPECT_FALSE(map.floor_near(0, -2, 0)) << "in the wall";
  EXPECT_FALSE(map.floor_near(0, -1.85, 0)) << "5 cm before it";
  EXPECT_TRUE(map.floor_near(0, -1.3, 0));
  EXPECT_TRUE(map.floor_near(0, -2.7, 0));
}

TEST(ServerGround, StepsAreClimbedAndTablesAreNot) {
  const GroundMap map =
      ground_of(*floor_with({{{1, 0.15f, 1}, {4, 0.15, 0}}, {{1, 0.5f, 1}, {-4, 0.5, 0}}}));
  ASSERT_TRUE(map.floor_near(4, 0, 0)) << "a step of 30 cm";
  EXPECT_NEAR(*map.floor_near(4, 0, 0), 0.3, 0.06);
  EXPECT_TRUE(map.floor_near(4.9, 0, 0.3)) << "and down again";
  EXPECT_FALSE(map.floor_near(-4, 0, 0)) << "a block of 1 m";
}

TEST(ServerGround, NobodyStandsUnderALowBeam) {
  const GroundMap map =
      ground_of(*floor_with({{{1, 0.1f, 1}, {4, 1.3, 0}}, {{1, 0.1f, 1}, {-4, 2.5, 0}}}));
  EXPECT_FALSE(map.floor_near(4, 0, 0)) << "1.2 m of room";
  EXPECT_TRUE(map.floor_near(-4, 0, 0)) << "2.4 m of room";
}

TEST(ServerGround, NobodyFallsOverTheEdge) {
  const GroundMap map = ground_of(*floor_with({}));
  EXPECT_TRUE(map.floor_near(0, 12, 0));
  const std::shared_ptr<const PreparedScene> hill =
      floor_with({{{3, 5, 3}, {0, 5, 0}}});  // its top is 10 m above the floor
  const GroundMap above = ground_of(*hill);
  EXPECT_TRUE(above.floor_near(0, 0, 10));
  EXPECT_FALSE(above.floor_near(2.95, 0, 10)) << "5 cm from the edge";
}

TEST(ServerGround, LeavesAreNoObstacle) {
  std::vector<SceneObject> objects = {box({20, 0.5f, 20}), box({1, 1, 1})};
  objects[1].mesh.primitives[0].material = 1;
  Scene scene = placed_scene(std::move(objects), {{0, {0, -0.5, 0}}, {1, {0, 1, 0}}});
  scene.materials.resize(2);
  scene.materials[1].alpha_mode = AlphaMode::kMask;
  scene.materials[1].base_color_map.image = 0;
  scene.images.push_back({2, 1, true, {255, 255, 255, 255, 255, 255, 255, 0}});
  const GroundMap solid = ground_of(*floor_with({{{1, 1, 1}, {0, 1, 0}}}));
  EXPECT_FALSE(solid.floor_near(1, 0, 0));
  const auto told = prepare_scene(std::move(scene));
  ASSERT_TRUE(told.ok());
  EXPECT_TRUE(ground_of(**told).floor_near(1, 0, 0));
}

TEST(ServerGround, FarFromTheOriginItIsTheSame) {
  const double far = 1e6 * kPerson.block_m();
  Scene scene = placed_scene({box({20, 0.5f, 20})}, {{0, {far, -0.5, far}}});
  const Result<GroundBlock> made =
      make_ground(**prepare_scene(std::move(scene)), kPerson, {1'000'000, 1'000'000});
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made->counts[32 * kGroundCells + 32], 1);
  EXPECT_NEAR(made->base_m + made->floors[0] * made->step_m, 0, 0.06);
}

TEST(ServerGround, WhereNothingIsThereIsNoFloor) {
  const Result<GroundBlock> made = make_ground(*floor_with({}), kPerson, {1000, 1000});
  ASSERT_TRUE(made.ok());
  EXPECT_TRUE(made->floors.empty());
}

TEST(ServerGround, DamagedBlocksAreRefused) {
  const Result<GroundBlock> made = make_ground(*floor_with({}), kPerson, {0, 0});
  ASSERT_TRUE(made.ok());
  const Bytes good = encode_ground(*made);
  const std::size_t size = ground_bytes(*made);
  EXPECT_TRUE(decode_ground(good, size).ok());
  for (const std::size_t wrong : {std::size_t{0}, size - 2, size + 2, std::size_t{1} << 40}) {
    EXPECT_FALSE(decode_ground(good, wrong).ok()) << wrong;
  }
  GroundBlock falling = *made;
  falling.counts[0] = 2;
  falling.floors.insert(falling.floors.begin(), {9, 9});
  falling.counts[1] = 0;
  falling.floors.resize(made->floors.size() + 2 - made->counts[0] - made->counts[1]);
  EXPECT_FALSE(decode_ground(encode_ground(falling), ground_bytes(falling)).ok());
  GroundBlock endless = *made;
  endless.base_m = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(decode_ground(encode_ground(endless), size).ok());
  Bytes cut = good;
  cut.resize(cut.size() / 2);
  EXPECT_FALSE(decode_ground(cut, size).ok());
}

}  // namespace
}  // namespace mirage::test

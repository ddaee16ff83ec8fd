// Footing: walls stop, steps are climbed, unknown ground waits.
#include "client/screen/footing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "client/scene/ground_map.h"

namespace mirage::test {
namespace {

constexpr double kEye = 1.75;  // cells of 25 cm
constexpr double kStep = 0.05;
constexpr double kClosed = -1;

/// Returns a map of the 3 x 3 blocks around the origin; `floor` returns the height of the floor at
/// a place, kClosed: none.
GroundMap map_of(const std::function<double(double, double)>& floor) {
  GroundMap map;
  map.reset({kEye});
  for (const GroundBlockId& id : map.missing_around(0, 0)) {
    GroundBlock block;
    block.id = id;
    block.step_m = kStep;
    for (int z = 0; z < kGroundCells; ++z) {
      for (int x = 0; x < kGroundCells; ++x) {
        const double height = floor((id.x * kGroundCells + x + 0.5) * map.body().cell_m(),
                                    (id.z * kGroundCells + z + 0.5) * map.body().cell_m());
        block.counts.push_back(height == kClosed ? 0 : 1);
        if (height != kClosed) {
          block.floors.push_back(static_cast<std::uint16_t>(std::lround(height / kStep)));
        }
      }
    }
    map.add(std::move(block));
  }
  return map;
}

double flat(double, double) { return 0; }

/// Walks from `eye` in parts of `by`, and returns where that leads.
glm::dvec3 walked(const GroundMap& map, glm::dvec3 eye, const glm::dvec3& by, int parts = 60) {
  Footing footing;
  for (int i = 0; i < parts; ++i) eye = footing.walk(map, eye, by);
  return eye;
}

TEST(ClientFooting, OnFlatGroundTheEyeKeepsItsHeight) {
  const glm::dvec3 eye = walked(map_of(flat), {1, kEye, 1}, {0.05, 0.4, -0.02});
  EXPECT_NEAR(eye.x, 4, 1e-9);
  EXPECT_NEAR(eye.z, -0.2, 1e-9);
  EXPECT_NEAR(eye.y, kEye, 1e-9) << "neither up nor down";
}

TEST(ClientFooting, AWallStopsAndOneSlidesAlong) {
  const GroundMap map = map_of([](double x, double) { return x > 3 ? kClosed : 0.0; });
  EXPECT_LE(walked(map, {1, kEye, 1}, {0.1, 0, 0}).x, 3);
  const glm::dvec3 along = walked(map, {1, kEye, 1}, {0.1, 0, 0.1});
  EXPECT_LE(along.x, 3);
  EXPECT_GT(along.z, 4) << "it slides";
  EXPECT_LE(walked(map, {1, kEye, 1}, {1000, 0, 0}, 1).x, 3) << "however long the step";
}

TEST(ClientFooting, AThinWallStopsFastWalkers) {
  const GroundMap map = map_of([](double x, double) { return x > 3 && x < 3.25 ? kClosed : 0.0; });
  for (const double fast : {0.1, 1.0, 7.0}) {
    EXPECT_LE(walked(map, {1, kEye, 1}, {fast, 0, 0}).x, 3) << fast;
  }
}

TEST(ClientFooting, StairsAreClimbedUpAndDown) {
  const GroundMap map = map_of([](double x, double) { return 0.25 * std::floor(std::abs(x)); });
  const glm::dvec3 up = walked(map, {0.5, kEye, 0}, {0.05, 0, 0}, 150);
  EXPECT_NEAR(up.x, 8, 1e-6);
  EXPECT_NEAR(up.y, kEye + 2, 0.3);
  const glm::dvec3 down = walked(map, up, {-0.05, 0, 0}, 150);
  EXPECT_NEAR(down.x, 0.5, 1e-6);
  EXPECT_NEAR(down.y, kEye, 0.3);
}

TEST(ClientFooting, TheEyeIsNeverLowOverTheGround) {
  const auto hills = [](double x, double z) { return 2 + std::sin(x) + std::cos(0.7 * z); };
  const GroundMap map = map_of(hills);
  Footing footing;
  glm::dvec3 eye(0, hills(0, 0) + kEye, 0);
  for (int i = 0; i < 1000; ++i) {
    const double turn = 0.013 * i;
    eye = footing.walk(map, eye, glm::dvec3(std::cos(turn), 0, std::sin(turn)) * 0.06);
    EXPECT_GT(eye.y, hills(eye.x, eye.z) + 0.5 * kEye);
    EXPECT_LT(eye.y, hills(eye.x, eye.z) + 1.5 * kEye);
  }
}

TEST(ClientFooting, ADropStops) {
  const GroundMap map = map_of([](double x, double) { return x > 3 ? 0.0 : 5.0; });
  const glm::dvec3 eye = walked(map, {1, 5 + kEye, 1}, {0.1, 0, 0});
  EXPECT_LE(eye.x, 3);
  EXPECT_NEAR(eye.y, 5 + kEye, 1e-6);
}

TEST(ClientFooting, UnknownGroundWaits) {
  GroundMap nothing;
  nothing.reset({kEye});
  Footing footing;
  EXPECT_EQ(footing.walk(nothing, {1, kEye, 1}, {1, 0, 0}), glm::dvec3(1, kEye, 1));
  EXPECT_TRUE(footing.stands());
  const double end = 2 * map_of(flat).body().block_m();  // the last known block ends there
  EXPECT_LT(walked(map_of(flat), {1, kEye, 1}, {0.5, 0, 0}, 200).x, end);
}

TEST(ClientFooting, FromAboveOneHoversUntilTheGround) {
  const GroundMap map = map_of(flat);
  Footing footing;
  glm::dvec3 eye(0, 30, 0);
  eye = footing.walk(map, eye, {0, -5, 1});
  EXPECT_EQ(eye, glm::dvec3(0, 25, 1)) << "free in all directions";
  EXPECT_FALSE(footing.stands());
  for (int i = 0; i < 10; ++i) eye = footing.walk(map, eye, {0.1, -5, 0});
  EXPECT_GE(eye.y, kEye - 1e-9) << "not into the ground";
  for (int i = 0; i < 30; ++i) eye = footing.walk(map, eye, {0.1, -5, 0});
  EXPECT_NEAR(eye.y, kEye, 0.05);
  EXPECT_TRUE(footing.stands());
}

TEST(ClientFooting, WhoIsInAThingStepsOutOfIt) {
  const GroundMap map =
      map_of([](double x, double z) { return std::hypot(x, z) < 1 ? kClosed : 0.0; });
  const glm::dvec3 eye = walked(map, {0, kEye, 0}, {0.01, 0, 0}, 1);
  EXPECT_GE(std::hypot(eye.x, eye.z), 0.9);
  EXPECT_LE(std::hypot(eye.x, eye.z), 1.6);
}

TEST(ClientFooting, WhoWasPutElsewhereStandsThere) {
  const GroundMap map = map_of([](double x, double) { return x > 3 ? 0.0 : 5.0; });
  Footing footing;
  glm::dvec3 eye = footing.walk(map, {1, 5 + kEye, 1}, {0.1, 0, 0});
  eye = footing.walk(map, {6, kEye, 1}, {0.1, 0, 0});  // by the home key
  EXPECT_NEAR(eye.y, kEye, 1e-6);
}

}  // namespace
}  // namespace mirage::test

#include <gtest/gtest.h>

#include <cmath>

#include "client/core/tile_fit.h"
#include "client/core/tile_need.h"
#include "tests/unit/core_scene.h"

namespace mirage {
namespace {

constexpr double kDegree = 0.017453292519943295;

TEST(CoreTileFit, DisocclusionsMayBeAsWideAsTheObjectIsLarge) {
  EXPECT_EQ(hole_tolerance(1, 1000), kHoleTolerance);
  EXPECT_NEAR(hole_tolerance(1, 20), 3, 1e-12);
  EXPECT_NEAR(hole_tolerance(0.25, 20), 3, 1e-12);  // of a quarter of a pixel
  EXPECT_EQ(hole_tolerance(4, 20), 1);
  EXPECT_EQ(hole_tolerance(1, 1e-9), 1);
}

// Degrees from the captured view within which a tile with stored depth, and holes behind steps as
// deep as 0.6 radii, meets a tau of 1 px.
double widest_angle(std::uint32_t picture_height) {
  constexpr double kDistance = 12;
  test::SelectorWorld world(test::make_scene({{}}));
  world.camera.width = world.camera.height = picture_height;
  world.look({0, 0, kDistance}, {0, 0, 0});
  const ObjectDescription& object = world.scene.objects[0];
  const InstanceView& instance = world.scene.instances[0];
  TileNeed need = need_for_view(view_geometry(world.camera, instance, object), ViewPlan{});
  need.size_class = kMaxAskedSizeClass;
  const Capture capture = test::capture_for(need, object.radius);
  Tile tile = test::make_tile(capture);
  tile.measure.depth_gap = 0.6f;
  world.cache.insert(0, world.scene, capture, tile, world.frame, 0);
  for (int degrees = 0; degrees < 80; ++degrees) {
    const double a = degrees * kDegree;
    world.look(kDistance * glm::dvec3(std::sin(a), 0, std::cos(a)), {0, 0, 0});
    const ViewGeometry view = view_geometry(world.camera, instance, object);
    if (!best_deep(*world.cache.group_to_draw(0), object, view, 1).meets(1)) return degrees - 1;
  }
  return 80;
}

TEST(CoreTileFit, ASmallReliefDoesNotServeFromFarAside) {
  for (const std::uint32_t height : {135u, 240u, 480u}) {
    const double angle = widest_angle(height);
    EXPECT_GE(angle, 3) << height;
    EXPECT_LE(angle, 16) << height;
  }
}

}  // namespace
}  // namespace mirage

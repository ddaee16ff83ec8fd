#include "client/plan/tile_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/plan/tile_need.h"
#include "protocol/impostor/instance_group.h"
#include "tests/support/core_scene.h"

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

// Returns the angle from the captured view, degrees, within which a tile with stored depth meets a
// tau of 1 px. It has holes behind steps that are 0.6 radii deep.
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

// A coarse tile seen from where it was captured errs less than a sharp one from aside. The sharp
// one is drawn nevertheless; otherwise it would be asked for again and again.
TEST(CoreTileFit, WhatIsSharpComesBeforeWhatErrsLess) {
  test::SelectorWorld world(test::make_scene({{}}));
  world.look({0, 0, 12}, {0, 0, 0});
  const ObjectDescription& object = world.scene.objects[0];
  const auto insert = [&](double degrees, bool coarse) {
    const double a = degrees * kDegree;
    world.look(12.0 * glm::dvec3(std::sin(a), 0, std::cos(a)), {0, 0, 0});
    TileNeed need =
        need_for_view(view_geometry(world.camera, world.scene.instances[0], object), ViewPlan{});
    if (coarse) need.size_class = coarse_class(need.size_class);
    const Capture capture = test::capture_for(need, object.radius);
    world.cache.insert(0, world.scene, capture, test::make_tile(capture), world.frame, 0);
    return capture.edge;
  };
  insert(0, true);
  const std::uint32_t sharp = insert(3, false);
  world.look({0, 0, 12}, {0, 0, 0});
  const ViewGeometry view = view_geometry(world.camera, world.scene.instances[0], object);
  const TileGroup& group = *world.cache.group_to_draw(0);
  const TileFit coarse = fit_of(group.tiles[0], DrawMethod::kQuad, object, view);
  const TileFit fine = fit_of(group.tiles[1], DrawMethod::kQuad, object, view);
  ASSERT_LT(coarse.error_px(1), fine.error_px(1));
  ASSERT_FALSE(coarse.sharp(1));
  ASSERT_TRUE(fine.settled(1));
  EXPECT_EQ(best_flat(group, object, view, 1).tile->capture.edge, sharp);
}

}  // namespace
}  // namespace mirage

// Eight views, the classic baseline: eight views around the horizon, the nearest one, never asked
// for twice.
#include "client/plan/eight_views.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/hold/tile_cache.h"
#include "protocol/impostor/capture.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/impostor/tile_key.h"

namespace mirage::test {
namespace {

constexpr double kDegree = 0.017453292519943295;

ViewGeometry seen_from(double azimuth_degrees, double elevation_degrees, double distance) {
  const double a = azimuth_degrees * kDegree, e = elevation_degrees * kDegree;
  ViewGeometry view;
  view.radius = 1;
  view.focal_px = 300;
  view.eye =
      distance * glm::dvec3(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
  view.forward = -glm::normalize(view.eye);
  view.center_depth = distance;
  return view;
}

TileRecordPtr record_of(const TileNeed& need, std::uint64_t serial) {
  auto record = std::make_shared<TileRecord>();
  record->capture = Capture(need.cell, need.distance, 1, tile_edge(need.size_class));
  record->serial = serial;
  return record;
}

TEST(EightViews, AsksForTheNearestAzimuthOnTheHorizonWhateverTheElevation) {
  const TileGroup none;
  const ViewGeometry view = seen_from(50, 40, 10);
  const auto need = eight_view_need(none, view, 30);
  ASSERT_TRUE(need);
  const glm::dvec3 direction = direction_from_view_cell(need->cell);
  const glm::dvec3 expected(std::sin(45 * kDegree), 0, std::cos(45 * kDegree));
  EXPECT_GT(glm::dot(direction, expected), 0.999999);
  EXPECT_EQ(eight_view_need(none, seen_from(60, -20, 30), 10)->cell, need->cell);
  EXPECT_FALSE(eight_view_need(none, seen_from(70, 0, 10), 30)->cell == need->cell);
}

TEST(EightViews, IsNeverStale) {
  TileGroup group;
  const ViewGeometry view = seen_from(45, 0, 10);
  TileNeed need = *eight_view_need(group, view, 30);
  need.size_class = static_cast<std::uint8_t>(need.size_class + 4);  // not the coarse first one
  group.tiles.push_back(record_of(need, 1));
  EXPECT_FALSE(eight_view_need(group, seen_from(45, 60, 3), 30));
  EXPECT_TRUE(eight_view_need(group, view, 300)) << "a sharper one where it is large";
  EXPECT_TRUE(eight_view_need(group, seen_from(90, 0, 10), 30)) << "another view";
}

TEST(EightViews, DrawsTheNearestAsAQuad) {
  TileGroup group;
  for (const double azimuth : {0.0, 90.0, 180.0}) {
    group.tiles.push_back(
        record_of(*eight_view_need(TileGroup{}, seen_from(azimuth, 0, 10), 30), 1));
  }
  const ObjectDescription object;
  EXPECT_EQ(nearest_view(group, object, seen_from(80, 10, 5)).tile, group.tiles[1]);
  EXPECT_EQ(nearest_view(group, object, seen_from(-120, 10, 5)).tile, group.tiles[2]);
  EXPECT_EQ(nearest_view(group, object, seen_from(80, 10, 5)).method, DrawMethod::kQuad);
  EXPECT_FALSE(nearest_view(TileGroup{}, object, seen_from(0, 0, 5)).tile);
}

TEST(EightViews, OfOneDirectionTheFinestIsDrawn) {
  TileGroup group;
  TileNeed need = *eight_view_need(group, seen_from(0, 0, 10), 30);
  group.tiles.push_back(record_of(need, 1));
  need.size_class = static_cast<std::uint8_t>(need.size_class + 4);
  group.tiles.push_back(record_of(need, 2));
  need.size_class = static_cast<std::uint8_t>(need.size_class - 2);
  group.tiles.push_back(record_of(need, 3));
  EXPECT_EQ(nearest_view(group, ObjectDescription{}, seen_from(10, 0, 10)).tile, group.tiles[1]);
}

}  // namespace
}  // namespace mirage::test

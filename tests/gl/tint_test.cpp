// Tints (keys 2 to 5): each pixel of a thing, and no other, has the colour of how it is drawn.

#include <gtest/gtest.h>

#include "client/draw/insight.h"
#include "tests/gl/bench.h"

namespace mirage::test {
namespace {

using Pixels = std::vector<std::uint8_t>;
constexpr glm::vec4 kRed{1, 0, 0, 1}, kNone{0};

class Tint : public ::testing::Test {
 protected:
  void SetUp() override {
    bench_ = Bench::create("builtin:knot?tubular=96&radial=24", BenchLight::kAlbedo);
    ASSERT_TRUE(bench_);
  }

  DrawList impostor(const Camera& camera, TileCache& cache, DrawMethod method) {
    DrawList list;
    list.impostors.push_back({0, bench_->tile_for(camera, cache), method, 0.5, 4, 1});
    return list;
  }
  static DrawList mesh() {
    DrawList list;
    list.meshes.push_back({0, 0, 1});
    return list;
  }

  /// Expects the colour where the picture shows the object, except at its edges, and nothing
  /// elsewhere. Returns the number of tinted pixels.
  static std::size_t expect_covers(const Pixels& tints, const Pixels& picture, const char* what) {
    EXPECT_EQ(tints.size(), picture.size()) << what;
    std::size_t wrong = 0, tinted = 0;
    for (std::size_t i = 0; i < tints.size(); i += 4) {
      const bool red = tints[i] > 250 && tints[i + 1] == 0 && tints[i + 3] > 250;
      const bool empty = tints[i] == 0 && tints[i + 3] == 0;
      tinted += red;
      if (picture[i + 3] == 255) wrong += !red;
      if (picture[i + 3] == 0) wrong += !empty;
    }
    EXPECT_LT(static_cast<double>(wrong), 0.01 * static_cast<double>(tinted)) << what;
    return tinted;
  }

  std::unique_ptr<Bench> bench_;
};

TEST_F(Tint, CoversWhatIsDrawnFromTiles) {
  const Camera camera = bench_->camera(4, glm::normalize(glm::dvec3(1, 0.4, 1)));
  TileCache cache = bench_->make_cache();
  for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kHull, DrawMethod::kDepth}) {
    DrawList list = impostor(camera, cache, method);
    ASSERT_TRUE(list.impostors[0].tile);
    const Pixels picture = bench_->picture(camera, list.impostors[0].tile, method);
    const std::size_t tinted =
        expect_covers(bench_->tints(camera, list, {{kRed}}), picture, "a tile");
    EXPECT_GT(tinted, 20'000u);
  }
}

TEST_F(Tint, CoversGeometryAlsoFromWithinItsSphere) {
  for (const double radii : {4.0, 0.95}) {
    Camera camera = bench_->camera(4, glm::normalize(glm::dvec3(1, 0.4, 1)));
    camera.pose.eye =
        bench_->instance().center - radii * bench_->instance().radius * camera.forward();
    if (radii < 1) camera.fov_y = 1.5;
    camera.near_m = 0.01;
    const Pixels picture = bench_->mesh_picture(camera);
    Tints tints;
    tints.meshes = kRed;
    const std::size_t tinted =
        expect_covers(bench_->tints(camera, mesh(), tints), picture, "geometry");
    EXPECT_GT(tinted, 20'000u) << radii;
  }
}

TEST_F(Tint, WhatHasNoneHidesWhatHas) {
  const Camera camera = bench_->camera(4, glm::dvec3(0, 0, 1));
  TileCache cache = bench_->make_cache();
  bench_->mesh_picture(camera);
  // A tile lies a little nearer than the surface that it shows.
  DrawList list = impostor(camera, cache, DrawMethod::kDepth);
  list.meshes = mesh().meshes;
  const auto red = [&](const glm::vec4& impostors) {
    const Pixels tints = bench_->tints(camera, list, {{impostors}, kNone, kRed});
    std::size_t count = 0;
    for (std::size_t i = 0; i < tints.size(); i += 4) count += tints[i] > 250;
    return count;
  };
  EXPECT_LT(red(kNone), red(kRed) / 4);
}

TEST_F(Tint, LayersHaveTheColoursOfTheirLegends) {
  const Camera camera = bench_->camera(4, glm::dvec3(0, 0, 1));
  TileCache cache = bench_->make_cache();
  DrawList list = impostor(camera, cache, DrawMethod::kQuad);
  list.impostors.push_back(list.impostors[0]);
  list.impostors[1].method = DrawMethod::kDepth;
  list.impostors[1].bound_px = 2;
  const auto red_of = [](const glm::vec4& tint) { return tint.r > 0.9f && tint.g < 0.3f; };
  const Tints sources = tints_of(InsightLayer::kSources, list, 1, 0);
  EXPECT_GT(sources.impostors[0].b, 0.9f) << "flat: blue";
  EXPECT_GT(sources.impostors[1].g, 0.9f) << "with depth: green";
  EXPECT_TRUE(red_of(sources.placeholders));
  EXPECT_EQ(sources.meshes.a, 1);
  const Tints bound = tints_of(InsightLayer::kBound, list, 1, 0);
  EXPECT_FALSE(red_of(bound.impostors[0])) << "half a pixel of one that is allowed";
  EXPECT_TRUE(red_of(bound.impostors[1])) << "twice as much";
  EXPECT_EQ(bound.meshes, kNone);
  const Tints age = tints_of(InsightLayer::kAge, list, 1, 90'000'000);
  EXPECT_TRUE(red_of(age.impostors[0]));
  const Tints geometry = tints_of(InsightLayer::kGeometry, list, 1, 0);
  EXPECT_EQ(geometry.impostors[0], kNone);
  EXPECT_EQ(geometry.placeholders, kNone);
  EXPECT_EQ(geometry.meshes, sources.meshes);
}

}  // namespace
}  // namespace mirage::test

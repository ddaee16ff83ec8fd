// Lines and points are a pixel wide in the truth, as geometry and on average in tiles, with any
// number of samples.

#include <gtest/gtest.h>

#include "tests/gl/bench.h"
#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

/// Returns eight spokes in the plane across the z axis, or the same corners as points.
std::string star(int mode) {
  std::string positions;
  for (int i = 0; i < 8; ++i) {
    const float angle = static_cast<float>(i) * 0.7853982f + 0.2f;
    for (const float radius : {0.2f, 1.0f}) {
      const float p[3] = {radius * std::cos(angle), radius * std::sin(angle), 0};
      positions.append(reinterpret_cast<const char*>(p), sizeof(p));
    }
  }
  const json document = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"materials", {{{"pbrMetallicRoughness", {{"baseColorFactor", {0.0, 0.0, 0.0, 1.0}}}}}}},
      {"meshes",
       {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", mode}, {"material", 0}}}}}}},
      {"buffers", {{{"byteLength", positions.size()}}}},
      {"bufferViews", {{{"buffer", 0}, {"byteLength", positions.size()}}}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", 5126},
         {"count", 16},
         {"type", "VEC3"},
         {"min", {-1, -1, 0}},
         {"max", {1, 1, 0}}}}}};
  return make_glb(document.dump(), positions);
}

/// Returns how much darker the picture is than the grey behind it, in whole black pixels of linear
/// light.
double darkness(const std::vector<std::uint8_t>& rgba) {
  const auto linear = [](int code) { return std::pow((code / 255.0 + 0.055) / 1.055, 2.4); };
  const double grey = linear(128);
  double sum = 0;
  for (std::size_t i = 0; i < rgba.size(); i += 4) sum += grey - linear(rgba[i]);
  return sum / grey;
}

void expect_same_width(int mode) {
  const TempFolder folder;
  const auto bench = Bench::create(folder.write("star.glb", star(mode)), BenchLight::kAlbedo);
  ASSERT_TRUE(bench);
  const Camera camera = bench->camera(4, glm::dvec3(0, 0, 1));
  const double one = darkness(bench->truth(camera, 1));
  ASSERT_GT(one, mode == 0 ? 12.0 : 1.0);
  EXPECT_NEAR(darkness(bench->truth(camera, 4)) / one, 1.0, 0.15);
  EXPECT_NEAR(darkness(bench->mesh_picture(camera)) / one, 1.0, 0.15);
  TileCache cache = bench->make_cache();
  const TileRecordPtr tile = bench->tile_for(camera, cache);
  ASSERT_TRUE(tile);
  // Tiles have 1.5 to 2.12 texels a pixel, this one 1.5: its strokes are as wide as they get. The
  // device rounds the width of lines to whole samples.
  constexpr double kStrokeTexels = 1.78, kTexelsPerPixel = 1.5;
  const double width = kStrokeTexels / kTexelsPerPixel;
  EXPECT_NEAR(darkness(bench->picture(camera, tile, DrawMethod::kQuad)) / one,
              mode == 0 ? width * width : width, 0.2);
}

TEST(Stroke, LinesAreAPixelWide) { expect_same_width(1); }
TEST(Stroke, PointsAreAPixelWide) { expect_same_width(0); }

}  // namespace
}  // namespace mirage::test

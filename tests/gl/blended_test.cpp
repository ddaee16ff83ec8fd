// Blended objects: tiles state the depth of the front, and how far behind it something shows. The
// bound covers both, the full render knows the front, and every covered pixel is compared.

#include <gtest/gtest.h>

#include "client/draw/geometric_error.h"
#include "client/frame/planned_frame.h"
#include "client/plan/tile_need.h"
#include "protocol/impostor/error_bound.h"
#include "server/render/gpu_scene.h"
#include "tests/gl/bench.h"
#include "tests/support/gltf_builder.h"

namespace mirage::test {
namespace {

constexpr float kPaneZ = 0.5f, kBoardZ = -0.5f;

/// Returns a glass pane of 2 x 2 before an opaque board of 1 x 1, as one object, both towards +z.
/// All of the board is seen through the pane.
std::string pane_before_board() {
  std::vector<float> positions;
  for (const auto& [half, z] : {std::pair{0.5f, kBoardZ}, {1.0f, kPaneZ}}) {
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}) {
      positions.insert(positions.end(),
                       {half * static_cast<float>(x), half * static_cast<float>(y), z});
    }
  }
  const auto part = [](int first, int material) {
    return json{{"attributes", {{"POSITION", first}}}, {"material", material}};
  };
  const auto accessor = [](std::size_t offset, float half, float z) {
    return json{
        {"bufferView", 0}, {"byteOffset", offset},     {"componentType", 5126}, {"count", 6},
        {"type", "VEC3"},  {"min", {-half, -half, z}}, {"max", {half, half, z}}};
  };
  const std::size_t bytes = positions.size() * sizeof(float);
  const json document = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"materials",
       {{{"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 0.2, 0.1, 1.0}}}}},
        {{"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.4, 1.0, 0.5}}}},
         {"alphaMode", "BLEND"}}}},
      {"meshes", {{{"primitives", {part(0, 0), part(1, 1)}}}}},
      {"buffers", {{{"byteLength", bytes}}}},
      {"bufferViews", {{{"buffer", 0}, {"byteLength", bytes}}}},
      {"accessors", {accessor(0, 0.5f, kBoardZ), accessor(bytes / 2, 1, kPaneZ)}}};
  return make_glb(document.dump(),
                  std::string(reinterpret_cast<const char*>(positions.data()), bytes));
}

class Blended : public testing::Test {
 protected:
  void SetUp() override {
    bench = Bench::create(folder.write("pane.glb", pane_before_board()), BenchLight::kLit, {}, 0,
                          BenchBlending::kKept);
    ASSERT_TRUE(bench);
  }
  const ObjectDescription& object() const { return bench->scene().objects[0]; }
  double bound(const TileRecord& tile, DrawMethod method, const Camera& camera) const {
    return tile.bound_px(method, object(), view_geometry(camera, bench->instance(), object()));
  }

  const TempFolder folder;
  std::unique_ptr<Bench> bench;
};

// A pane of 4 square metres and alpha 0.5 before a board of 1: (4 x 0.5 + 1) / 5 of it is opaque.
TEST_F(Blended, PlaceholderIsAsTransparentAsItsObject) {
  EXPECT_NEAR(bench->scene().objects[0].opacity, 0.6, 1e-5);
  EXPECT_NEAR(bench->scene().objects[0].mean_color.b, (2 * 1.0 + 1 * 0.1) / 3, 0.01);
  const std::vector<std::uint8_t> picture =
      bench->placeholder_picture(bench->camera(4, glm::dvec3(0, 0, 1)));
  constexpr std::size_t kMiddle = (Bench::kSize / 2 * Bench::kSize + Bench::kSize / 2) * 4;
  EXPECT_NEAR(picture[kMiddle + 3], 0.6 * 255, 1);
  EXPECT_EQ(picture[3], 0) << "a corner, where there is nothing";
}

TEST_F(Blended, TileTellsTheFrontAndWhatShowsBehindIt) {
  const Camera camera = bench->camera(4, glm::dvec3(0, 0, 1));
  TileCache cache = bench->make_cache();
  const TileRecordPtr tile = bench->tile_for(camera, cache);
  ASSERT_TRUE(tile);
  const double dc = tile->capture.distance, step = 1.5 / 254;  // step of the depth code, rounded up
  const double pane = dc - kPaneZ, board = dc - kBoardZ;
  const double range = 2 * object().radius / (dc * dc - double{object().radius} * object().radius);
  EXPECT_NEAR(tile->measure.dz_behind, dc * dc * (1 / pane - 1 / board), dc * dc * range * step);
  EXPECT_NEAR(tile->measure.depth_min, pane, 0.03);
  EXPECT_NEAR(tile->measure.depth_max, board, 0.03);
  // Nothing shows through from behind.
  const TileRecordPtr back = bench->tile_for(bench->camera(4, glm::dvec3(1, 0.2, 0.02)), cache);
  ASSERT_TRUE(back);
  EXPECT_LT(back->measure.dz_behind, tile->measure.dz_behind);
}

TEST_F(Blended, TheBoundCoversWhatLiesBehind) {
  TileCache cache = bench->make_cache();
  const TileRecordPtr tile = bench->tile_for(bench->camera(6, glm::dvec3(0, 0, 1)), cache);
  ASSERT_TRUE(tile);
  const Camera aside = bench->camera(6, turned(glm::dvec3(0, 0, 1), 2, 0.4));
  // The tile shows the board's middle through the pane, and it is drawn on the pane.
  const glm::dvec3 center(object().center);
  const glm::dvec3 board = glm::dvec3(0, 0, kBoardZ) - center, eye = tile->capture.eye();
  const double to_board = tile->capture.depth(board), to_pane = to_board - (kPaneZ - kBoardZ);
  const glm::dvec3 drawn = eye + (board - eye) * (to_pane / to_board);
  const glm::dvec3 from = aside.pose.eye - bench->instance().center;
  const double error = point_error_px(aside.focal_px(), board - from, drawn - from, aside.forward(),
                                      aside.right(), aside.up());
  EXPECT_GT(error, 3);
  EXPECT_GE(bound(*tile, DrawMethod::kDepth, aside), error);
  TileRecord blind = *tile;
  blind.measure.dz_behind = 0;
  blind.seal(object());
  EXPECT_LT(bound(blind, DrawMethod::kDepth, aside), error) << "nothing else would cover it";
  // Box and hull have the pane's plane in front; the quad lies between the two.
  EXPECT_GE(bound(*tile, DrawMethod::kCuboid, aside), error);
  EXPECT_GE(bound(*tile, DrawMethod::kHull, aside), error);
  const glm::dvec3 on_quad = eye + (board - eye) * (double{tile->measure.plane_depth} / to_board);
  const double flat = point_error_px(aside.focal_px(), board - from, on_quad - from,
                                     aside.forward(), aside.right(), aside.up());
  EXPECT_GT(flat, 0.4 * error);
  EXPECT_GE(bound(*tile, DrawMethod::kQuad, aside), flat);
}

TEST_F(Blended, TheFullRenderKnowsTheFront) {
  const Camera camera = bench->camera(4, glm::dvec3(0, 0, 1));
  const ReferenceFrame truth = bench->truth_frame(camera, 1);
  const auto at = [&](double x, double y) {  // on the plane z
    const glm::dvec3 p = glm::dvec3(x, y, 0) - camera.pose.eye;
    const double scale = camera.focal_px() / glm::dot(p, camera.forward());
    const auto px =
        static_cast<std::size_t>(0.5 * camera.width + scale * glm::dot(p, camera.right()));
    const auto py =
        static_cast<std::size_t>(0.5 * camera.height - scale * glm::dot(p, camera.up()));
    return py * camera.width + px;
  };
  EXPECT_EQ(truth.ids[at(0, 0)], 1u);
  EXPECT_NEAR(truth.depth[at(0.1, 0.1)], camera.pose.eye.z - kPaneZ, 1e-3);
  EXPECT_NEAR(truth.depth[at(0.8, 0.8)], camera.pose.eye.z - kPaneZ, 1e-3) << "beside the board";
}

TEST_F(Blended, EveryCoveredPixelIsComparedAndNoneIsOverItsBound) {
  for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kCuboid, DrawMethod::kHull,
                                  DrawMethod::kWarp, DrawMethod::kDepth}) {
    GeometricError errors;
    for (int i = 0; i < 3; ++i) {
      TileCache cache = bench->make_cache();
      const glm::dvec3 d = glm::normalize(glm::dvec3(0.2 * i, 0.1, 1));
      const TileRecordPtr tile = bench->tile_for(bench->camera(12, d), cache);
      ASSERT_TRUE(tile);
      const Camera c = bench->camera(12, turned(d, 0.5 * i, 1.3 * i));
      DrawnImpostor drawn{0, tile, method, bound(*tile, method, c), glm::length(c.pose.eye), 1};
      DrawList list;
      list.impostors.push_back(drawn);
      add_geometric_error(bench->truth_frame(c, 1), 0.5, {c, &bench->scene(), list, {}}, errors);
    }
    EXPECT_EQ(errors.violations, 0u) << "method " << static_cast<int>(method);
    EXPECT_GT(errors.compared, 19 * errors.object_pixels / 20)
        << "of " << errors.object_pixels << ", method " << static_cast<int>(method);
  }
}

}  // namespace
}  // namespace mirage::test

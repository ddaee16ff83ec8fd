// Layered tiles: what the front hides is there, and is drawn from aside at its own depth. From the
// capture the picture is that of a lit tile.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "client/plan/tile_need.h"
#include "protocol/codec/tile_color.h"
#include "protocol/impostor/error_bound.h"
#include "tests/gl/bench.h"
#include "tests/support/data_folder.h"
#include "tests/support/gltf_builder.h"

namespace mirage::test {
namespace {

constexpr float kSlatsZ = 0.5f, kBehindZ = -0.5f;
constexpr int kSlats = 8;  // as wide as the gaps between them

/// Returns red slats before a blue board of 2 x 2, as one object with an alpha test, towards +z.
std::string slats_before_board() {
  Builder b;
  std::vector<float> positions;
  const auto rectangle = [&](float x0, float x1, float z) {
    for (const auto& [x, y] : {std::pair{x0, -1.0f}, {x1, -1}, {x1, 1}, {x0, -1}, {x1, 1}, {x0, 1}})
      positions.insert(positions.end(), {x, y, z});
  };
  const auto part = [&](int material) {
    const int accessor = b.accessor(positions, "VEC3", 5126, 3);
    positions.clear();
    return json{{"attributes", {{"POSITION", accessor}}}, {"material", material}};
  };
  // Blended in the file: the bench makes an alpha test of it, which the import would find to be
  // none.
  const auto tested = [](float red, float blue) {
    return json{{"pbrMetallicRoughness", {{"baseColorFactor", {red, 0.1, blue, 0.9}}}},
                {"alphaMode", "BLEND"}};
  };
  rectangle(-1, 1, kBehindZ);
  const json board = part(0);
  for (int i = 0; i < kSlats; ++i) {
    const float x = -1 + 2.0f * static_cast<float>(i) / kSlats;
    rectangle(x, x + 1.0f / kSlats, kSlatsZ);
  }
  const json slats = part(1);
  b.doc["scene"] = 0;
  b.doc["scenes"] = {{{"nodes", {0}}}};
  b.doc["nodes"] = {{{"mesh", 0}}};
  b.doc["materials"] = {tested(0.1f, 0.9f), tested(0.9f, 0.1f)};
  b.doc["meshes"] = {{{"primitives", {board, slats}}}};
  b.doc["buffers"] = {{{"byteLength", b.bin.size()}}};
  return make_glb(b.doc.dump(), b.bin);
}

class Layers : public testing::Test {
 protected:
  void open(const std::string& spec) {
    bench = Bench::create(spec, BenchLight::kAlbedo);
    ASSERT_TRUE(bench);
  }
  void open_slats() { open(folder.write("slats.glb", slats_before_board())); }
  double psnr(const Camera& from, const Camera& camera, std::uint8_t channels, DrawMethod method) {
    TileCache cache = bench->make_cache();
    const TileRecordPtr tile = bench->tile_for(from, cache, channels);
    if (!tile) return 0;
    const std::vector<std::uint8_t> drawn = bench->picture(camera, tile, method);
    const std::vector<std::uint8_t> truth = bench->truth(camera, 4);
    constexpr std::uint32_t kEdge = Bench::kSize;
    return field_fidelity({kEdge, kEdge, truth.data()}, {kEdge, kEdge, drawn.data()})
        .psnr_db.value_or(0);
  }
  const TempFolder folder;
  std::unique_ptr<Bench> bench;
};

const glm::dvec3 kAhead(0, 0, 1);

TEST_F(Layers, TheSecondHoldsWhatTheFirstHides) {
  ASSERT_NO_FATAL_FAILURE(open_slats());
  const Camera camera = bench->camera(4, kAhead);
  TileCache cache = bench->make_cache();
  const TileRecordPtr tile = bench->tile_for(camera, cache, kLayeredTile);
  ASSERT_TRUE(tile && tile->layered());
  const double dc = tile->capture.distance;
  int hidden = 0;
  for (std::size_t i = 0; i < tile->depth.size(); ++i) {
    if (tile->behind_depth[i] == 0) continue;
    ++hidden;
    EXPECT_NEAR(tile->depth_code.decode(tile->depth[i]), dc - kSlatsZ, 0.03);
    EXPECT_NEAR(tile->depth_code.decode(tile->behind_depth[i]), dc - kBehindZ, 0.03);
  }
  EXPECT_GT(hidden, static_cast<int>(tile->depth.size()) / 3);
  EXPECT_GE(tile->measure.depth_max, dc - kBehindZ);
}

TEST_F(Layers, SlatsFromAsideShowTheBoardBehindThem) {
  ASSERT_NO_FATAL_FAILURE(open_slats());
  for (const double degrees : {4.0, 10.0}) {
    const Camera camera = bench->camera(4, kAhead);
    const Camera from = bench->camera(4, turned(kAhead, degrees, 0.2));
    const double one = psnr(from, camera, kLitTile, DrawMethod::kDepth);
    const double two = psnr(from, camera, kLayeredTile, DrawMethod::kDepth);
    std::printf("[ FIGURES  ] slats, %g deg: %.1f dB in one layer, %.1f in two\n", degrees, one,
                two);
    EXPECT_GT(two, one + 2) << degrees;
  }
}

TEST_F(Layers, FromTheCaptureItIsTheLitTile) {
  ASSERT_NO_FATAL_FAILURE(open_slats());
  const Camera camera = bench->camera(4, glm::normalize(glm::dvec3(0.3, 0.2, 1)));
  const double one = psnr(camera, camera, kLitTile, DrawMethod::kQuad);
  const double two = psnr(camera, camera, kLayeredTile, DrawMethod::kQuad);
  EXPECT_NEAR(one, two, 0.2);
}

// Points of the board that the tile has behind its slats are drawn at the depth stored there.
TEST_F(Layers, TheBoundCoversWhatTheSecondShows) {
  ASSERT_NO_FATAL_FAILURE(open_slats());
  TileCache cache = bench->make_cache();
  const TileRecordPtr tile = bench->tile_for(bench->camera(6, kAhead), cache, kLayeredTile);
  ASSERT_TRUE(tile && tile->layered());
  const Camera aside = bench->camera(6, turned(kAhead, 8, 0.4));
  const ObjectDescription& object = bench->scene().objects[0];
  const double bound =
      tile->bound_px(DrawMethod::kDepth, object, view_geometry(aside, bench->instance(), object));
  const glm::dvec3 from = aside.pose.eye - bench->instance().center, eye = tile->capture.eye();
  const double board_z = kBehindZ - double{object.center.z};
  double worst = 0, worst_flat = 0;
  for (std::uint32_t y = 0; y < tile->crop.h; ++y) {
    for (std::uint32_t x = 0; x < tile->crop.w; ++x) {
      const std::size_t i = std::size_t{y} * tile->crop.w + x;
      if (tile->behind_depth[i] == 0) continue;
      const glm::dvec2 texel(tile->crop.x + x + 0.5, tile->crop.y + y + 0.5);
      const glm::dvec3 ray = tile->capture.point_from_texel(texel, 1.0) - eye;
      const glm::dvec3 board = eye + ray * ((board_z - eye.z) / ray.z);
      const auto error = [&](std::uint8_t code) {
        const glm::dvec3 drawn = eye + ray * tile->depth_code.decode(code);
        return point_error_px(aside.focal_px(), board - from, drawn - from, aside.forward(),
                              aside.right(), aside.up());
      };
      worst = std::max(worst, error(tile->behind_depth[i]));
      worst_flat = std::max(worst_flat, error(tile->depth[i]));
    }
  }
  EXPECT_GT(worst, 0);
  EXPECT_LE(worst, bound);
  EXPECT_GT(worst_flat, bound) << "at the front's depth it would not hold";
}

TEST_F(Layers, TheTreeFromAside) {
  const std::string tree = (data_folder() / "assets/reference/tree.glb").string();
  ASSERT_TRUE(std::ifstream(tree)) << tree;
  ASSERT_NO_FATAL_FAILURE(open(tree));
  const glm::dvec3 direction = fibonacci_direction(0, 4);
  const Camera camera = bench->camera(4, direction);
  for (const double degrees : {5.0, 10.0}) {
    const Camera from = bench->camera(4, turned(direction, degrees, 0));
    const double one = psnr(from, camera, kLitTile, DrawMethod::kDepth);
    const std::size_t bytes = bench->tile_bytes();
    const double two = psnr(from, camera, kLayeredTile, DrawMethod::kDepth);
    std::printf("[ FIGURES  ] tree, %g deg: %.1f dB in %zu bytes, %.1f in %zu\n", degrees, one,
                bytes, two, bench->tile_bytes());
    EXPECT_GT(two, one + 2.3) << degrees;
    EXPECT_LT(static_cast<double>(bench->tile_bytes()), 1.65 * static_cast<double>(bytes));
  }
}

}  // namespace
}  // namespace mirage::test

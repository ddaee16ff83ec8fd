// Relief keeps solid things solid: no pixel inside the outline shows what is behind the object.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/gl/bench.h"
#include "tests/support/gltf_builder.h"

namespace mirage::test {
namespace {

struct Box {
  glm::vec3 low, high;
};

/// Returns black boxes with two triangles a side.
std::string boxes_glb(const std::vector<Box>& boxes) {
  std::vector<float> corners;
  std::vector<std::uint16_t> indices;
  for (const Box& box : boxes) {
    const auto first = static_cast<std::uint16_t>(corners.size() / 3);
    for (int i = 0; i < 8; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        corners.push_back(i >> axis & 1 ? box.high[axis] : box.low[axis]);
      }
    }
    for (const int i : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}) {
      indices.push_back(static_cast<std::uint16_t>(first + i));
    }
  }
  Builder builder;
  const int position = builder.vec3(corners);
  builder.mesh({{"POSITION", position}}, builder.indices(indices));
  builder.doc["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorFactor", {0.0, 0.0, 0.0, 1.0}}}}}};
  builder.primitive()["material"] = 0;
  return builder.glb();
}

bool dark(const std::vector<std::uint8_t>& rgba, int x, int y) {
  return rgba[4 * (y * Bench::kSize + x)] < 64;
}

/// Pixels that the truth covers two pixels around, and those of them that the picture leaves open.
struct Inside {
  int pixels = 0, open = 0;
};

Inside inside(const std::vector<std::uint8_t>& truth, const std::vector<std::uint8_t>& drawn) {
  constexpr int kMargin = 2;
  Inside out;
  for (int y = kMargin; y < Bench::kSize - kMargin; ++y) {
    for (int x = kMargin; x < Bench::kSize - kMargin; ++x) {
      bool covered = true;
      for (int dy = -kMargin; dy <= kMargin && covered; ++dy) {
        for (int dx = -kMargin; dx <= kMargin && covered; ++dx) {
          covered = dark(truth, x + dx, y + dy);
        }
      }
      if (!covered) continue;
      ++out.pixels;
      if (!dark(drawn, x, y)) ++out.open;
    }
  }
  return out;
}

/// Draws the tile taken from `capture`, seen from `eye` (directions from the centre).
Inside relief_inside(const std::vector<Box>& boxes, const glm::dvec3& capture,
                     const glm::dvec3& eye) {
  const TempFolder folder;
  const auto bench =
      Bench::create(folder.write("boxes.glb", boxes_glb(boxes)), BenchLight::kAlbedo);
  if (!bench) return {};
  TileCache cache = bench->make_cache();
  const TileRecordPtr tile = bench->tile_for(bench->camera(4, glm::normalize(capture)), cache);
  if (!tile) return {};
  const Camera camera = bench->camera(4, glm::normalize(eye));
  return inside(bench->truth(camera, 4), bench->picture(camera, tile, DrawMethod::kDepth));
}

TEST(Relief, SteepSurfacesHaveNoPinholes) {
  const std::vector<Box> table = {{{-1, -0.02f, -0.7f}, {1, 0.02f, 0.7f}}};
  for (const double bearing : {0.0, 0.4, 0.9}) {
    const glm::dvec3 low(std::sin(bearing), 0.05, std::cos(bearing));
    const Inside seen = relief_inside(table, low, low + glm::dvec3(0.03, 0.1, 0));
    EXPECT_GT(seen.pixels, 5'000);
    EXPECT_EQ(seen.open, 0) << "of " << seen.pixels << " at " << bearing;
  }
}

TEST(Relief, WallsAreFilledBehindThinBoards) {
  std::vector<Box> shelf = {{{-1, -1, -0.3f}, {1, 1, -0.28f}},
                            {{-1, -1, -0.3f}, {-0.97f, 1, 0.3f}}};
  for (const float y : {-0.5f, 0.0f, 0.5f}) shelf.push_back({{-1, y, -0.3f}, {1, y + 0.03f, 0.3f}});
  for (const double side : {-0.12, -0.06}) {
    const Inside seen =
        relief_inside(shelf, glm::dvec3(0.2, 0.1, 1), glm::dvec3(0.2 + side, 0.1, 1));
    EXPECT_GT(seen.pixels, 50'000);
    EXPECT_LE(seen.open, seen.pixels / 2000) << "of " << seen.pixels << " at " << side;
  }
}

// Flat impostors and relief are drawn in one order. So the far one of two trees is seen behind the
// soft edges of the near one, whichever way it is drawn.
TEST(Relief, IsSeenBehindSoftEdgesOfFlatImpostors) {
  std::vector<Box> fence;
  for (float x = -1; x < 1; x += 0.05f) fence.push_back({{x, -1, -0.01f}, {x + 0.02f, 1, 0.01f}});
  const TempFolder folder;
  const auto bench =
      Bench::create(folder.write("fence.glb", boxes_glb(fence)), BenchLight::kAlbedo);
  ASSERT_TRUE(bench);
  TileCache cache = bench->make_cache();
  const Camera camera = bench->camera(6, glm::normalize(glm::dvec3(0.3, 0.1, 1)));
  const TileRecordPtr tile = bench->tile_for(camera, cache);
  ASSERT_TRUE(tile);
  constexpr double kBehindRadii = 2;
  const auto drawn = [&](DrawMethod near_method, DrawMethod far_method) {
    return bench->picture_of_two(camera, tile, kBehindRadii, near_method, far_method);
  };
  const std::vector<std::uint8_t> alone = bench->picture(camera, tile, DrawMethod::kQuad);
  const std::vector<std::uint8_t> flat = drawn(DrawMethod::kQuad, DrawMethod::kQuad);
  const std::vector<std::uint8_t> relief = drawn(DrawMethod::kQuad, DrawMethod::kDepth);
  // The far fence shows through edges of the near one, where its method makes little difference.
  int behind = 0, missing = 0;
  for (std::size_t i = 0; i < flat.size(); i += 4) {
    const int edge = std::abs(flat[i] - alone[i]);
    const bool covered = alone[i] < 120;  // the background is 128
    if (edge < 16 || !covered) continue;
    ++behind;
    if (std::abs(relief[i] - alone[i]) < edge / 4) ++missing;
  }
  EXPECT_GT(behind, 200);
  EXPECT_LT(missing, behind / 10) << "of " << behind;
}

}  // namespace
}  // namespace mirage::test

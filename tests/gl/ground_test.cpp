// The ground in tiles of groups: it hides what is under it, and shows nothing of itself.
#include <gtest/gtest.h>

#include <algorithm>

#include "protocol/base/limits.h"
#include "server/prepare/prepared_scene.h"
#include "server/tile/tile_encode.h"
#include "tests/bench/drawn_tiles.h"
#include "tests/bench/stages.h"
#include "tests/support/boxes.h"

namespace mirage::test {
namespace {

// Returns the texels with content of the tile of the largest group of 64 plates, seen from above.
// `top`: height of the ground over the plates, metres; it is `depth` deep.
std::size_t texels_over(double top, double depth = 1) {
  PlacedObjects placed = {{1, {0, top - 0.5 * depth, 0}}};
  for (int i = 0; i < 64; ++i) placed.push_back({0, {1.0 * (i % 8), 0, 1.0 * (i / 8)}});
  const std::shared_ptr<const PreparedScene> scene = *prepare_scene(
      placed_scene({box({0.15f, 0.001f, 0.1f}), box({20, 0.5 * depth, 20})}, placed));
  constexpr std::uint32_t kEdge = 64;
  std::uint32_t serial = 0;
  TileJob job = bench::tiles_of(*scene, 1, kEdge, serial)[0];
  job.key.object = static_cast<std::uint32_t>(scene->objects.size());
  job.key.cell = *view_cell_from_direction({0.1, 1, 0.1}, limits::kMaxViewLevel);
  job.id = tile_id(job.key);
  EXPECT_EQ(scene->group(job.key.object)->leaves, 64u);
  const auto drawn = bench::draw_jobs(scene, {job}, kEdge);
  EXPECT_TRUE(drawn.ok()) << drawn.error().text;
  if (!drawn) return 0;
  const Tile tile = cut_and_measure(drawn->front(), *scene->description(job.key.object));
  return static_cast<std::size_t>(std::count_if(tile.depth.begin(), tile.depth.end(),
                                                [](std::uint8_t code) { return code != 0; }));
}

TEST(GlGround, AGroupShowsNothingThatIsUnderTheGround) {
  const std::size_t over = texels_over(-0.1);
  EXPECT_GT(over, 64u);
  EXPECT_EQ(texels_over(0.1), 0u);
}

TEST(GlGround, GroundBeforeTheCaptureHidesNothing) {
  EXPECT_EQ(texels_over(30, 31), texels_over(-0.1));
}

}  // namespace
}  // namespace mirage::test

// Tile measure: what the server measures on a tile's texels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "protocol/impostor/object_proxy.h"
#include "server/tile/tile_measure.h"

namespace mirage::test {
namespace {

// A box about the centre, cut by planes that leave the centre within.
std::vector<Plane> random_body(std::mt19937& random, const glm::dvec3& center) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> offset(0.2, 0.6);
  std::vector<Plane> planes;
  for (const double sign : {-1.0, 1.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 n(0);
      n[axis] = sign;
      planes.push_back({glm::vec3(n), static_cast<float>(glm::dot(n, center) + 0.55)});
    }
  }
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    planes.push_back({glm::vec3(n), static_cast<float>(glm::dot(n, center) + offset(random))});
  }
  return planes;
}

TEST(ServerMeasure, EntryDepthsAreThoseOfTheRays) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> cells(0, 63), buckets(0, 20);
  const TileCrop crop{3, 5, 50, 41};
  int met = 0, missed = 0;
  for (int round = 0; round < 60; ++round) {
    const glm::dvec3 center(0.3 * round, -2, 1);
    const std::vector<Plane> planes = random_body(random, center);
    const ViewCell cell{6, static_cast<std::uint16_t>(cells(random)),
                        static_cast<std::uint16_t>(cells(random))};
    const Capture capture(cell, *distance_bucket_from_radii(1.5 + buckets(random), 3), 1, 64);
    const std::vector<float> entry = entry_depths(planes, capture, center, crop);
    for (std::uint32_t y = 0; y < crop.h; ++y) {
      for (std::uint32_t x = 0; x < crop.w; ++x) {
        const glm::dvec2 texel(crop.x + x + 0.5, crop.y + y + 0.5);
        const auto along = [&](const glm::dvec2& at) {
          const glm::dvec3 direction = capture.point_from_texel(at, 1.0) - capture.eye();
          return ray_entry(planes, center + capture.eye(), direction);
        };
        const double expected = along(texel);
        const float found = entry[y * crop.w + x];
        // Rounding may decide either way at the rim of the body.
        const double least = std::min(along(texel - 1e-6), along(texel + 1e-6));
        const double most = std::max(along(texel - 1e-6), along(texel + 1e-6));
        if ((least < 0) != (most < 0)) continue;
        ASSERT_EQ(std::isnan(found), expected < 0) << round << ": " << x << ", " << y;
        if (expected < 0) {
          ++missed;
          continue;
        }
        ++met;
        ASSERT_NEAR(found, expected, 1e-6 * expected) << round << ": " << x << ", " << y;
      }
    }
  }
  EXPECT_GT(met, 10'000);
  EXPECT_GT(missed, 10'000);
}

}  // namespace
}  // namespace mirage::test

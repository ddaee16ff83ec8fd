#include "server/bake/alpha_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace mirage {
namespace {

float apart(int a, int b, int size) {
  return std::hypot(float(a % size - b % size), float(a / size - b / size));
}

// Compares with all distances, for frames from nearly empty to nearly full.
TEST(AlphaField, FindsTheNearestTexelExactly) {
  std::mt19937 random(5);
  for (const int size : {1, 2, 7, 24}) {
    for (const double share : {.01, .1, .5, .98}) {
      TexelMask chosen(size * size);
      for (auto& c : chosen) c = std::bernoulli_distribution(share)(random) ? 1 : 0;
      const NearestTexels found = nearest_texels(chosen, size);
      for (int t = 0; t < size * size; ++t) {
        float least = std::numeric_limits<float>::infinity();
        for (int s = 0; s < size * size; ++s) {
          if (chosen[s]) least = std::min(least, apart(t, s, size));
        }
        if (std::isinf(least)) {
          ASSERT_EQ(found.texel[t], -1);
          ASSERT_TRUE(std::isinf(found.distance[t]));
          continue;
        }
        ASSERT_NEAR(found.distance[t], least, 1e-4);
        ASSERT_TRUE(chosen[found.texel[t]]);
        ASSERT_NEAR(apart(t, found.texel[t], size), least, 1e-4);
      }
    }
  }
}

// A square of 4 texels in a frame of 10.
TexelMask square() {
  TexelMask inside(100);
  for (int y = 3; y < 7; ++y) {
    for (int x = 3; x < 7; ++x) inside[y * 10 + x] = 1;
  }
  return inside;
}

TEST(AlphaField, GrowsInward) {
  const auto field = inner_field(square(), 10, 4);
  EXPECT_EQ(field[2 * 10 + 5], 0);
  EXPECT_EQ(field[3 * 10 + 5], .25f);
  EXPECT_EQ(field[4 * 10 + 5], .5f);
  EXPECT_EQ(inner_field(TexelMask(9, 1), 3, 4)[4], 1) << "nothing is outside";
}

TEST(AlphaField, CrossesAHalfAtTheOutline) {
  const auto field = signed_field(square(), 10, 4);
  EXPECT_NEAR(field[3 * 10 + 5] - .5f, .5f - field[2 * 10 + 5], 1e-6);
  EXPECT_GT(field[3 * 10 + 5], .5f);
  EXPECT_NEAR(field[4 * 10 + 5], .5f + .5f * 1.5f / 3.5f, 1e-6);
  EXPECT_EQ(field[0], (1 - std::min((std::sqrt(18.0f) - .5f) / 3.5f, 1.0f)) / 2);
  EXPECT_EQ(signed_field(TexelMask(9, 0), 3, 4)[4], 0);
  EXPECT_EQ(signed_field(TexelMask(9, 1), 3, 4)[4], 1);
}

}  // namespace
}  // namespace mirage

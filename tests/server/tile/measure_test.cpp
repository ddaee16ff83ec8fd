// Tile measure: what the server measures on a tile's texels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "protocol/impostor/object_proxy.h"
#include "server/tile/proxy_entry.h"
#include "server/tile/tile_measure.h"
#include "tests/support/measure_reference.h"

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
    const std::vector<float> entry = ProxyEntry(planes, capture, center, crop).depths();
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

// Discs of content at depths that a step, noise or a slope gives.
std::vector<std::uint8_t> random_codes(std::mt19937& random, const TileCrop& crop, int kind) {
  std::uniform_int_distribution<int> any(1, 255), small(0, 9);
  const int base = any(random), disc = 4 + 3 * small(random);
  std::vector<std::uint8_t> out(crop.area(), 0);
  for (std::uint32_t y = 0; y < crop.h; ++y) {
    for (std::uint32_t x = 0; x < crop.w; ++x) {
      const int dx = static_cast<int>(x) - 25, dy = static_cast<int>(y) - 20;
      if (dx * dx + dy * dy > disc * disc / 4) continue;
      const int slope = base + dx * small(random) / 9 + dy;
      const int code = kind == 0 ? any(random) : kind == 1 ? slope : base + small(random);
      out[std::size_t{y} * crop.w + x] = static_cast<std::uint8_t>(std::clamp(code, 1, 255));
    }
  }
  return out;
}

TEST(ServerMeasure, DifferencesAreThoseOfEveryTexel) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> cells(0, 63), buckets(0, 20);
  const TileCrop crop{3, 5, 50, 41};
  int usable = 0, unusable = 0;
  for (int round = 0; round < 300; ++round) {
    const glm::dvec3 center(0.3 * round, -2, 1);
    const std::vector<Plane> planes = random_body(random, center);
    const ViewCell cell{6, static_cast<std::uint16_t>(cells(random)),
                        static_cast<std::uint16_t>(cells(random))};
    const Capture capture(cell, *distance_bucket_from_radii(1.5 + buckets(random), 3), 1, 64);
    const std::vector<std::uint8_t> codes = random_codes(random, crop, round % 3);
    const CodedDepths content(codes, crop, DepthCode(capture.radius, capture.distance));
    const auto dc = static_cast<float>(capture.distance);
    const auto none = static_cast<float>(100.0 * capture.distance);
    const float expected = plain_difference(planes, capture, center, crop, codes);
    const float found = ProxyEntry(planes, capture, center, crop).difference(content, dc, none);
    ASSERT_EQ(found, expected) << round;
    ++(expected == none ? unusable : usable);
  }
  EXPECT_GT(usable, 60);
  EXPECT_GT(unusable, 20);
}

// A flat box: rays enter and leave at one depth, and rounding alone decides which they meet.
TEST(ServerMeasure, AFlatProxyIsMetAsEveryTexelSays) {
  std::mt19937 random(5);
  const TileCrop crop{3, 5, 50, 41};
  const std::vector<Plane> planes = box_planes({-0.5f, 0.1f, -0.5f}, {0.5f, 0.1f, 0.5f});
  for (std::uint16_t x = 0; x < 64; ++x) {
    const Capture capture({6, x, 20}, *distance_bucket_from_radii(3, 3), 1, 64);
    const std::vector<std::uint8_t> codes = random_codes(random, crop, 1);
    const CodedDepths content(codes, crop, DepthCode(capture.radius, capture.distance));
    const float found = ProxyEntry(planes, capture, {}, crop)
                            .difference(content, static_cast<float>(capture.distance),
                                        static_cast<float>(100.0 * capture.distance));
    ASSERT_EQ(found, plain_difference(planes, capture, {}, crop, codes)) << x;
  }
}

TEST(ServerMeasure, TheCropIsTheContentAndATexel) {
  std::mt19937 random(3);
  constexpr std::uint32_t kEdge = 32, kWidth = 48;
  std::uniform_int_distribution<std::uint32_t> place(0, kEdge - 1);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::uint8_t> rgba(kWidth * kEdge * 4, 0), depth(kWidth * kEdge, 0);
    std::uint32_t x0 = kEdge, y0 = kEdge, x1 = 0, y1 = 0;
    for (int i = 0; i < round % 4; ++i) {
      const std::uint32_t x = place(random), y = place(random);  // y from the top
      rgba[((kEdge - 1 - y) * kWidth + x) * 4 + 3] = 1;
      x0 = std::min(x0, x), x1 = std::max(x1, x + 1);
      y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
    }
    rgba[kEdge * 4 + 3] = 255;  // a neighbour in the page
    const Capture capture({0, 0, 0}, *distance_bucket_from_radii(3, 3), 1, kEdge);
    const PageTexels page{rgba.data(), depth.data(), nullptr, static_cast<int>(kWidth)};
    const TileCrop found = cut_tile(page, kLitTile, capture, {}).crop;
    if (round % 4 == 0) {
      ASSERT_EQ(found.area(), 0u);
      continue;
    }
    ASSERT_EQ(found.x, x0 > 0 ? x0 - 1 : 0);
    ASSERT_EQ(found.y, y0 > 0 ? y0 - 1 : 0);
    ASSERT_EQ(found.x + found.w, std::min(x1 + 1, kEdge));
    ASSERT_EQ(found.y + found.h, std::min(y1 + 1, kEdge));
  }
}

}  // namespace
}  // namespace mirage::test

// The time that a tile of some size takes a server.
#include "client/price/server_work.h"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/impostor/tile_key.h"

namespace mirage {
namespace {

double texels(std::uint8_t size_class) { return std::pow(tile_edge(size_class), 2); }

TEST(ServerWork, LearnsAFixedTimeAndATimeForEachTexel) {
  ServerWork work;
  const auto true_us = [](std::uint8_t size_class) { return 6000 + 0.5 * texels(size_class); };
  for (int i = 0; i < 60; ++i) {
    const auto size_class = static_cast<std::uint8_t>(2 + i % 9);
    work.arrived(size_class, std::llround(true_us(size_class)));
  }
  for (std::uint8_t size_class = 0; size_class < 11; ++size_class) {
    EXPECT_NEAR(work.expected_us(size_class) / true_us(size_class), 1, 0.02) << int{size_class};
  }
}

TEST(ServerWork, AServerWhoseTilesAllTakeTheSameSaysSo) {
  ServerWork work;
  for (int i = 0; i < 60; ++i) work.arrived(static_cast<std::uint8_t>(i % 12), 5000);
  EXPECT_NEAR(work.expected_us(0), 5000, 100);
  EXPECT_NEAR(work.expected_us(11), 5000, 100);
}

TEST(ServerWork, NumbersThatNoServerMeansAreBounded) {
  ServerWork work;
  work.arrived(4, 0);
  work.arrived(4, -5);
  work.arrived(4, INT64_MAX);
  work.arrived(4, INT64_MIN);
  EXPECT_TRUE(std::isfinite(work.expected_us(12)));
  EXPECT_GT(work.expected_us(0), 0);
}

}  // namespace
}  // namespace mirage

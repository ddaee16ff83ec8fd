// Posed extent: extremes over many poses equal those of looking at every point in double.
#include "server/prepare/posed_extent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace mirage {
namespace {

using Points = std::vector<glm::vec3>;

Points ball_at(std::mt19937& random, std::size_t count, const glm::vec3& center, float radius) {
  std::uniform_real_distribution<float> even(-1, 1);
  Points out;
  while (out.size() < count) {
    const glm::vec3 p(even(random), even(random), even(random));
    if (glm::dot(p, p) <= 1) out.push_back(center + radius * p);
  }
  return out;
}

TEST(ServerPosedExtent, IsThatOfEveryPoint) {
  std::mt19937 random(1);
  for (const std::size_t count : {std::size_t{1}, std::size_t{63}, std::size_t{1'001}}) {
    const glm::vec3 center(3, -1, 0.5f);
    PosedExtent extent(center);
    double radius2 = 0;
    std::vector<double> support(PosedExtent::kDirections, -INFINITY);
    std::vector<glm::dvec3> farthest(PosedExtent::kDirections);
    PointBox box;
    for (int pose = 0; pose < 200; ++pose) {
      const float turn = 0.1f * static_cast<float>(pose);
      const Points points =
          ball_at(random, count, center + 0.3f * glm::vec3(std::cos(turn), std::sin(turn), 0), 1);
      extent.add(points);
      box.add(points);
      for (const glm::vec3& p : points) {
        const glm::dvec3 off = glm::dvec3(p) - glm::dvec3(center);
        radius2 = std::max(radius2, glm::dot(off, off));
        for (std::size_t i = 0; i < support.size(); ++i) {
          const double reach = glm::dot(extent.directions()[i], glm::dvec3(p));
          if (reach > support[i]) farthest[i] = p;
          support[i] = std::max(support[i], reach);
        }
      }
    }
    EXPECT_EQ(extent.radius2(), radius2);
    EXPECT_EQ(extent.box().low, box.low);
    EXPECT_EQ(extent.box().high, box.high);
    for (std::size_t i = 0; i < support.size(); ++i) EXPECT_EQ(extent.points()[i], farthest[i]);
  }
}

TEST(ServerPosedExtent, LargestStepIsFoundWhereverItIs) {
  std::mt19937 random(2);
  const Points from = ball_at(random, 131, glm::vec3(0), 1);
  for (std::size_t i = 0; i < from.size(); ++i) {
    Points to = from;
    for (glm::vec3& p : to) p.y += 0.01f;
    to[i] = from[i] + glm::vec3(2, 3, 6);
    EXPECT_NEAR(largest_step(from, to), 7, 1e-5) << i;
  }
  EXPECT_EQ(largest_step(from, from), 0);
}

}  // namespace
}  // namespace mirage

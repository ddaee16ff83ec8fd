#include "server/bake/lattice.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mirage {
namespace {

using glm::dvec3;

// Directions all over the sphere, none of them in a plane of symmetry.
std::vector<dvec3> directions() {
  std::vector<dvec3> out;
  for (int n = 0; n < 500; ++n) {
    const double y = 1 - (n + .5) / 250, angle = .3 + n * 2.399963;
    const double r = std::sqrt(1 - y * y);
    out.push_back({r * std::cos(angle), y, r * std::sin(angle)});
  }
  return out;
}

dvec3 l1(const dvec3& v) { return v / (std::abs(v.x) + std::abs(v.y) + std::abs(v.z)); }

TEST(Lattice, HasTheCornersOfTheHemisphere) {
  const int n = 8;
  const auto at = [&](int i, int j) { return frame_direction(BakeLayout::kHemi, n, i, j); };
  EXPECT_LT(distance(at(0, 0), dvec3(0, 0, -1)), 1e-12);
  EXPECT_LT(distance(at(n - 1, 0), dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(distance(at(0, n - 1), dvec3(-1, 0, 0)), 1e-12);
  EXPECT_LT(distance(at(n - 1, n - 1), dvec3(0, 0, 1)), 1e-12);
}

TEST(Lattice, HasThePolesOfTheWholeSphere) {
  const int n = 9;
  const auto at = [&](int i, int j) { return frame_direction(BakeLayout::kOctahedral, n, i, j); };
  EXPECT_LT(distance(at(4, 4), dvec3(0, 1, 0)), 1e-12);
  for (const int i : {0, n - 1}) {
    for (const int j : {0, n - 1}) EXPECT_LT(distance(at(i, j), dvec3(0, -1, 0)), 1e-12);
  }
  EXPECT_LT(distance(at(8, 4), dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(distance(at(4, 8), dvec3(0, 0, 1)), 1e-12);
}

TEST(Lattice, FindsThePlaceOfEachFrame) {
  for (const auto layout : {BakeLayout::kHemi, BakeLayout::kOctahedral}) {
    const int n = 7;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const dvec3 direction = frame_direction(layout, n, i, j);
        EXPECT_NEAR(length(direction), 1, 1e-12);
        const glm::dvec2 place = lattice_place(layout, n, direction);
        // Frames at the border of the whole sphere come twice.
        EXPECT_LT(distance(l1(direction),
                           l1(frame_direction(layout, n, int(place.x + .5), int(place.y + .5)))),
                  1e-9);
        if (layout == BakeLayout::kHemi) {
          EXPECT_LT(distance(place, glm::dvec2(i, j)), 1e-9);
        }
      }
    }
  }
}

// Inside a face of the octahedron, directions divided by the sum of their parts are a plane, so
// three frames of one face give back the direction between them.
TEST(Lattice, BlendsTheFramesAroundADirection) {
  int told = 0;
  for (const auto layout : {BakeLayout::kHemi, BakeLayout::kOctahedral}) {
    const int n = 9;
    for (const auto& direction : directions()) {
      if (layout == BakeLayout::kHemi && direction.y < .05) continue;
      const FrameBlend blend = frame_blend(layout, n, direction);
      dvec3 mean(0);
      double sum = 0;
      bool one_face = true;
      for (int k = 0; k < 3; ++k) {
        const auto f = blend.frame[k];
        ASSERT_TRUE(f.x >= 0 && f.y >= 0 && f.x < n && f.y < n);
        ASSERT_GE(blend.weight[k], 0);
        const dvec3 own = frame_direction(layout, n, f.x, f.y);
        one_face = one_face && own.x * direction.x >= -1e-12 && own.y * direction.y >= -1e-12 &&
                   own.z * direction.z >= -1e-12;
        mean += l1(own) * blend.weight[k];
        sum += blend.weight[k];
      }
      EXPECT_NEAR(sum, 1, 1e-12);
      if (!one_face) continue;
      ++told;
      EXPECT_LT(distance(mean, l1(direction)), 1e-9)
          << name_of(layout) << " " << direction.x << " " << direction.y << " " << direction.z;
    }
  }
  EXPECT_GT(told, 400);
}

TEST(Lattice, BlendsNeighboursOfARing) {
  const int n = 4;
  for (const auto& direction : directions()) {
    const FrameBlend blend = frame_blend(BakeLayout::kRing, n, direction);
    EXPECT_NEAR(blend.weight[0] + blend.weight[1] + blend.weight[2], 1, 1e-12);
    const dvec3 flat = normalize(dvec3(direction.x, 0, direction.z));
    for (const auto& f : {blend.frame[0], blend.frame[1]}) {
      const dvec3 own = frame_direction(BakeLayout::kRing, n, f.x, f.y);
      EXPECT_GT(dot(own, flat), std::cos(2 * M_PI / (n * n)) - 1e-9);
    }
  }
}

TEST(Lattice, RollsFramesUprightExceptAtThePole) {
  const RollRule rule{.99, {0, 0, 1}};
  for (const auto& direction : directions()) {
    const FrameBasis b = frame_basis(rule, direction);
    EXPECT_NEAR(dot(b.right, b.up), 0, 1e-12);
    EXPECT_LT(distance(cross(b.right, b.up), b.toward), 1e-12);
    if (std::abs(direction.y) <= rule.polar_from) {
      EXPECT_NEAR(b.right.y, 0, 1e-12);
      EXPECT_GT(b.up.y, 0);
    } else {
      EXPECT_GT(b.up.z, .9);
    }
  }
  const FrameBasis pole = frame_basis({}, {0, 1, 0});
  EXPECT_LT(distance(pole.right, dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(distance(pole.up, dvec3(0, 0, -1)), 1e-12);
}

}  // namespace
}  // namespace mirage

// View cells, distance buckets and the stable forms under them.
#include "protocol/impostor/view_cell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"

namespace mirage::test {
namespace {

constexpr double kCellNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kCellInf = std::numeric_limits<double>::infinity();

/// Directions where an octahedral map breaks: folds, corners, poles; and anywhere.
class Directions {
 public:
  glm::dvec3 next() {
    const double tiny = std::pow(10.0, -1 - 17 * uniform_(random_));
    switch (kind_++ % 6) {
      case 0:
        return {signed_unit(), tiny * signed_unit(), signed_unit()};  // the fold y = 0
      case 1:
        return {tiny * signed_unit(), signed_unit(), signed_unit()};  // x = 0
      case 2:
        return {signed_unit(), signed_unit(), tiny * signed_unit()};  // z = 0
      case 3:
        return {tiny * signed_unit(), sign(), tiny * signed_unit()};  // poles, outer corners
      case 4:  // exactly on axes and folds, with zeros of both signs
        return {corner(), sign(), corner()};
      default:
        return {signed_unit(), signed_unit(), signed_unit()};
    }
  }
  double uniform() { return uniform_(random_); }

 private:
  double signed_unit() { return 2 * uniform_(random_) - 1; }
  double corner() {
    constexpr double kValues[] = {0.0, -0.0, 1.0, -1.0};
    return kValues[static_cast<int>(uniform_(random_) * 4)];
  }
  double sign() { return uniform_(random_) < 0.5 ? -1 : 1; }
  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> uniform_{0, 1};
  int kind_ = 0;
};

TEST(ProtocolViewCell, EncodeOfDecodeIsTheKey) {
  Directions directions;
  for (int i = 0; i < 1'000'000; ++i) {
    const int level = i % (limits::kMaxViewLevel + 1);
    const auto cell = view_cell_from_direction(directions.next(), level);
    ASSERT_TRUE(cell);
    ASSERT_TRUE(valid(*cell));
    const auto again = view_cell_from_direction(direction_from_view_cell(*cell), level);
    ASSERT_TRUE(again);
    ASSERT_EQ(*again, *cell) << "level " << level << " cell " << cell->x << " " << cell->y;
  }
}

TEST(ProtocolViewCell, CornersOfTheGrid) {
  for (int level = 0; level <= limits::kMaxViewLevel; ++level) {
    const auto last = static_cast<std::uint16_t>((1u << level) - 1);
    const auto half = static_cast<std::uint16_t>((1u << level) / 2);
    for (const auto& [x, y] : {std::pair{std::uint16_t{0}, std::uint16_t{0}},
                               {last, last},
                               {std::uint16_t{0}, last},
                               {half, half},
                               {half, last}}) {
      const ViewCell cell{static_cast<std::uint8_t>(level), x, y};
      const auto again = view_cell_from_direction(direction_from_view_cell(cell), level);
      ASSERT_EQ(*again, cell);
    }
  }
  EXPECT_FALSE(valid(ViewCell{3, 8, 0}));
  EXPECT_FALSE(valid(ViewCell{3, 0, 8}));
  EXPECT_FALSE(valid(ViewCell{limits::kMaxViewLevel + 1, 0, 0}));
}

TEST(ProtocolViewCell, LengthDoesNotMatter) {
  Directions directions;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 v = glm::normalize(directions.next() + glm::dvec3(0, 1e-3, 0));
    const auto cell = view_cell_from_direction(v, 9);
    // Powers of two scale without rounding, so even a direction on a cell's edge keeps its key.
    for (const double exponent : {-66.0, 66.0, -1000.0, 1000.0}) {
      ASSERT_EQ(view_cell_from_direction(v * std::exp2(exponent), 9), cell);
    }
  }
  for (const double length : {1e-20, 1.0, 1e20, 1e-300, 1e300}) {
    EXPECT_EQ(view_cell_from_direction(glm::dvec3(.3, -.5, .4) * length, 16),
              view_cell_from_direction({.3, -.5, .4}, 16));
  }
}

TEST(ProtocolViewCell, NoDirectionNoCell) {
  EXPECT_FALSE(view_cell_from_direction({0, 0, 0}, 4));
  for (int i = 0; i < 3; ++i) {
    for (const double bad : {kCellNan, kCellInf, -kCellInf}) {
      glm::dvec3 v(1, 2, 3);
      v[i] = bad;
      EXPECT_FALSE(view_cell_from_direction(v, 4)) << i << " " << bad;
    }
  }
}

// The client chooses the level by this angle, so it must hold at every level, even coarse ones.
TEST(ProtocolViewCell, AngleToTheCenterIsBounded) {
  Directions directions;
  std::vector<double> worst(limits::kMaxViewLevel + 1, 0.0);
  for (int i = 0; i < 300'000; ++i) {
    const int level = i % (limits::kMaxViewLevel + 1);
    const glm::dvec3 v = directions.next();
    const auto cell = view_cell_from_direction(v, level);
    worst[level] = std::max(worst[level], angle_between(v, direction_from_view_cell(*cell)));
  }
  for (int level = 0; level <= limits::kMaxViewLevel; ++level) {
    EXPECT_LE(worst[level], view_cell_angle(level) * (1 + 1e-9)) << "level " << level;
    EXPECT_GT(worst[level], view_cell_angle(level) * 0.25) << "level " << level;
  }
}

TEST(ProtocolViewCell, LevelForAngleIsTheCoarsestThatKeepsIt) {
  for (double angle = 3; angle > 1e-4; angle *= 0.77) {
    const int level = view_level_for_angle(angle);
    EXPECT_LE(view_cell_angle(level), angle);
    if (level > 0) {
      EXPECT_GT(view_cell_angle(level - 1), angle);
    }
  }
  EXPECT_EQ(view_level_for_angle(0), limits::kMaxViewLevel);
  EXPECT_EQ(view_level_for_angle(kCellNan), limits::kMaxViewLevel);
  EXPECT_EQ(view_level_for_angle(1e-300), limits::kMaxViewLevel);
}

void expect_orthonormal(const CaptureBasis& b) {
  ASSERT_NEAR(glm::length(b.right), 1, 1e-12);
  ASSERT_NEAR(glm::length(b.up), 1, 1e-12);
  ASSERT_NEAR(glm::length(b.forward), 1, 1e-12);
  ASSERT_NEAR(glm::dot(b.right, b.up), 0, 1e-12);
  ASSERT_NEAR(glm::dot(b.right, b.forward), 0, 1e-12);
  ASSERT_NEAR(glm::dot(b.up, b.forward), 0, 1e-12);
  // The axes are right-handed, and the camera looks along -z: right x up = -forward.
  ASSERT_NEAR(glm::length(glm::cross(b.right, b.up) + b.forward), 0, 1e-12);
}

TEST(ProtocolViewCell, BasisIsOrthonormalAlsoAtThePoles) {
  Directions directions;
  for (int i = 0; i < 50'000; ++i) {
    expect_orthonormal(capture_basis(*view_cell_from_direction(directions.next(), i % 17)));
  }
  for (const double y : {1.0, -1.0}) {
    for (const double off : {0.0, 1e-12, 1e-7, -1e-7, 1e-4, 9.9e-4, 1.01e-3}) {
      const auto cell = view_cell_from_direction({off, y, -off * 0.5}, limits::kMaxViewLevel);
      const CaptureBasis basis = capture_basis(*cell);
      expect_orthonormal(basis);
      ASSERT_LT(glm::length(basis.forward + direction_from_view_cell(*cell)), 1e-12);
    }
  }
  // Up leans towards world up away from the poles.
  EXPECT_GT(capture_basis(*view_cell_from_direction({1, .2, .3}, 8)).up.y, 0.9);
}

TEST(ProtocolDistanceBucket, RoundTripMonotoneAndClose) {
  for (const int level : {0, 1, 4, 8, 16}) {
    std::int32_t last = std::numeric_limits<std::int32_t>::min();
    const double half_step = std::exp2(0.5 / std::exp2(level));
    for (double radii = 1.2; radii < 1e6; radii *= 1.0137) {
      const auto bucket = distance_bucket_from_radii(radii, level);
      ASSERT_TRUE(bucket);
      ASSERT_TRUE(valid(*bucket)) << radii;
      ASSERT_GE(bucket->index, last);
      last = bucket->index;
      const double middle = radii_from_distance_bucket(*bucket);
      ASSERT_EQ(distance_bucket_from_radii(middle, level), bucket);
      // Close to the limits, the bucket may be a neighbour that lies in range.
      const double allowed =
          radii < 2.5 || radii > 4e5 ? half_step * half_step * half_step : half_step * (1 + 1e-12);
      ASSERT_LE(std::max(middle / radii, radii / middle), allowed) << radii << " level " << level;
    }
  }
}

TEST(ProtocolDistanceBucket, Limits) {
  for (const double bad : {0.0, -1.0, kCellNan, kCellInf, -kCellInf}) {
    EXPECT_FALSE(distance_bucket_from_radii(bad, 4)) << bad;
  }
  EXPECT_TRUE(valid(*distance_bucket_from_radii(1e-3, 4)));
  EXPECT_TRUE(valid(*distance_bucket_from_radii(1e300, 4)));
  EXPECT_FALSE(valid(DistanceBucket{4, -1000}));
  EXPECT_FALSE(valid(DistanceBucket{4, 1 << 20}));
  EXPECT_FALSE(valid(DistanceBucket{0, std::numeric_limits<std::int32_t>::max()}));
  EXPECT_FALSE(valid(DistanceBucket{16, std::numeric_limits<std::int32_t>::min()}));
  EXPECT_FALSE(valid(DistanceBucket{limits::kMaxDistanceLevel + 1, 100}));
}

// Each stable form beside the textbook one: the first agrees with long double, the second shows why
// it is not used.
TEST(ProtocolStableMath, AngleBetween) {
  for (double theta = 1e-12; theta < 3; theta *= 3.7) {
    const glm::dvec3 a(1, 0, 0), b(std::cos(theta), std::sin(theta), 0);
    EXPECT_NEAR(angle_between(a, b), theta, 1e-14 + theta * 1e-12) << theta;
  }
  const glm::dvec3 a(1, 0, 0), b(std::cos(1e-9), std::sin(1e-9), 0);
  EXPECT_GT(std::abs(std::acos(glm::dot(a, b)) - 1e-9), 0.5e-9);
  EXPECT_NEAR(angle_between(a, -a), 3.14159265358979323846, 1e-15);
  EXPECT_TRUE(std::isnan(angle_between(a, glm::dvec3(0))));
}

TEST(ProtocolStableMath, OneMinusCos) {
  for (double x = 1e-150; x < 3; x *= 11) {
    const long double half = std::sin(0.5L * static_cast<long double>(x));
    const long double exact = 2 * half * half;
    EXPECT_NEAR(static_cast<double>(one_minus_cos(x) / exact), 1, 1e-14) << x;
  }
  EXPECT_EQ(1 - std::cos(1e-9), 0);  // naive: all digits gone
  EXPECT_GT(one_minus_cos(1e-9), 0);
}

TEST(ProtocolStableMath, TangentLength) {
  const double r = 6371e3, d = r + 1e-2;
  const long double h = static_cast<long double>(d) - r;
  const long double exact = std::sqrt(h * (2.0L * r + h));
  EXPECT_NEAR(static_cast<double>(tangent_length(d, r) / exact), 1, 1e-14);
  // One centimetre over a planet the difference of squares has lost half of its digits.
  EXPECT_GT(std::abs(static_cast<double>(std::sqrt(d * d - r * r) / exact) - 1), 1e-10);
}

TEST(ProtocolStableMath, SmoothingGain) {
  for (double x = 1e-300; x < 1e3; x *= 1e7) {
    const long double exact = -std::expm1(-static_cast<long double>(x));
    EXPECT_NEAR(static_cast<double>(smoothing_gain(x) / exact), 1, 1e-14) << x;
  }
  EXPECT_EQ(1 - std::exp(-1e-17), 0);
  EXPECT_EQ(smoothing_gain(1e-17), 1e-17);
  EXPECT_EQ(smoothing_gain(1e300), 1);
}

TEST(ProtocolStableMath, SafeNormalize) {
  for (const double scale : {1e-308, 1e-160, 1.0, 1e160, 1e307}) {
    EXPECT_NEAR(glm::length(safe_normalize(glm::dvec3(1, -2, 2) * scale)), 1, 1e-14) << scale;
  }
  EXPECT_FALSE(glm::length(glm::normalize(glm::dvec3(1, -2, 2) * 1e-200)) < 2);
  EXPECT_EQ(safe_normalize(glm::dvec3(0)), glm::dvec3(0));
  EXPECT_EQ(safe_normalize({kCellNan, 1, 1}), glm::dvec3(0));
  EXPECT_EQ(safe_normalize({1, kCellNan, 1}), glm::dvec3(0));
  EXPECT_EQ(safe_normalize({1, 1, kCellInf}), glm::dvec3(0));
}

}  // namespace
}  // namespace mirage::test

// Predictor: damped velocity and its gate (numerics.md section 4, P1-9).
#include "client/plan/predictor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace mirage::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxSpeed = 50;
constexpr std::int64_t kFrameUs = 16'667;

Pose pose_at(const glm::dvec3& eye, double yaw = 0) {
  return {eye, glm::angleAxis(static_cast<float>(yaw), glm::vec3(0, 1, 0))};
}

/// Adds sixty frames along x at `speed`, turning at `yaw_rate`. Returns the time of the last one.
std::int64_t run_straight(Predictor& predictor, double speed, double yaw_rate = 0) {
  std::int64_t t = 0;
  for (int i = 0; i < 60; ++i) {
    t = i * kFrameUs;
    const double s = static_cast<double>(t) * 1e-6;
    predictor.add(t, pose_at({speed * s, 1.7, 0}, yaw_rate * s));
  }
  return t;
}

double angle(const glm::quat& a, const glm::quat& b) {
  const glm::dquat d = glm::dquat(a) * glm::conjugate(glm::dquat(b));
  return 2 * std::atan2(glm::length(glm::dvec3(d.x, d.y, d.z)), std::abs(d.w));
}

TEST(CorePredictor, ConstantVelocity) {
  for (const double speed : {0.1, 1.4, 10.0}) {
    Predictor predictor(kMaxSpeed);
    const std::int64_t t = run_straight(predictor, speed, 0.5);
    EXPECT_NEAR(glm::length(predictor.velocity_mps()), speed, 1e-6 * speed);
    for (const double h : {0.05, 0.1, 0.2, 0.4}) {
      const Pose predicted = predictor.predict(std::llround(h * 1e6));
      // The motion is expected to die down: T (1 - exp(-h/T)), T = 0.8 s and 0.4 s. The tolerance
      // covers the rounding of times to whole microseconds, and of rotations to float.
      const double eye = speed * (static_cast<double>(t) * 1e-6 - 0.8 * std::expm1(-h / 0.8));
      EXPECT_NEAR(predicted.eye.x, eye, 1e-6 * speed);
      EXPECT_NEAR(predicted.eye.y, 1.7, 1e-12);
      const double yaw = 0.5 * (static_cast<double>(t) * 1e-6 - 0.4 * std::expm1(-h / 0.4));
      EXPECT_LT(angle(predicted.rotation, pose_at({}, yaw).rotation), 1e-4);
    }
  }
}

TEST(CorePredictor, UselessSamplesAreDropped) {
  Predictor predictor(kMaxSpeed);
  const std::int64_t t = run_straight(predictor, 1.4);
  const Pose before = predictor.predict(100'000);
  predictor.add(t, pose_at({5, 5, 5}));          // dt = 0
  predictor.add(t - 5'000, pose_at({5, 5, 5}));  // dt < 0
  predictor.add(t + 1'000, pose_at({kNan, 0, 0}));
  predictor.add(t + 2'000, pose_at({std::numeric_limits<double>::infinity(), 0, 0}));
  predictor.add(t + 3'000, {{0, 0, 0}, glm::quat(0, 0, 0, 0)});
  predictor.add(t + 4'000, {{0, 0, 0}, glm::quat(static_cast<float>(kNan), 0, 0, 0)});
  const Pose after = predictor.predict(100'000);
  EXPECT_EQ(before.eye, after.eye);
  EXPECT_EQ(before.rotation, after.rotation);
}

TEST(CorePredictor, NearlySimultaneousSamplesAreMerged) {
  // 1e-9 s is 0 in whole microseconds, and is dropped. 1 to 99 us replace the pose, not the
  // velocity.
  Predictor predictor(kMaxSpeed);
  const std::int64_t t = run_straight(predictor, 1.4);
  const double speed = glm::length(predictor.velocity_mps());
  const glm::dvec3 eye = predictor.predict(0).eye + glm::dvec3(0, 0.01, 0);
  predictor.add(t + 99, pose_at(eye));
  EXPECT_EQ(glm::length(predictor.velocity_mps()), speed);
  EXPECT_EQ(predictor.predict(0).eye, eye);
}

TEST(CorePredictor, PauseRestarts) {
  Predictor predictor(kMaxSpeed);
  const std::int64_t t = run_straight(predictor, 1.4);
  predictor.add(t + 10'000'000, pose_at({20, 1.7, 0}));
  EXPECT_FALSE(predictor.has_velocity());
  EXPECT_EQ(predictor.predict(400'000).eye, glm::dvec3(20, 1.7, 0));
}

TEST(CorePredictor, JumpNeverCarriesTheViewAway) {
  std::mt19937 random(3);
  Predictor predictor(kMaxSpeed);
  std::int64_t t = run_straight(predictor, 1.4);
  glm::dvec3 eye = predictor.predict(0).eye;
  for (int i = 0; i < 2000; ++i) {
    t += 100 + static_cast<std::int64_t>(random() % 40'000);
    const bool jump = random() % 20 == 0;
    eye += glm::dvec3(jump ? 1e6 : 0.02, 0, 0) * (random() % 2 == 0 ? 1.0 : -1.0);
    predictor.add(t, pose_at(eye));
    for (const std::int64_t h : {1'000, 100'000, 1'000'000}) {
      const double moved = glm::length(predictor.predict(h).eye - predictor.predict(0).eye);
      // The sums are around 1e6 m, where double has a precision of 1e-9 m.
      ASSERT_LE(moved, kMaxSpeed * static_cast<double>(h) * 1e-6 + 1e-6);
    }
    if (jump) {
      ASSERT_EQ(predictor.predict(0).eye, eye);
      ASSERT_FALSE(predictor.has_velocity());
    }
  }
}

TEST(CorePredictor, SignOfTheQuaternionMeansNothing) {
  Predictor plain(kMaxSpeed), flipped(kMaxSpeed);
  for (int i = 0; i < 60; ++i) {
    Pose pose = pose_at({0.02 * i, 0, 0}, 0.01 * i);
    plain.add(i * kFrameUs, pose);
    if (i % 3 == 0) pose.rotation = -pose.rotation;
    flipped.add(i * kFrameUs, pose);
    const Pose a = plain.predict(200'000), b = flipped.predict(200'000);
    ASSERT_EQ(a.eye, b.eye);
    ASSERT_LT(angle(a.rotation, b.rotation), 1e-6);
  }
}

TEST(CorePredictor, StillHeadWithNoiseStaysPut) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 1e-4);
  Predictor predictor(kMaxSpeed);
  for (int i = 0; i < 20'000; ++i) {
    predictor.add(i * kFrameUs, pose_at({noise(random), noise(random), noise(random)}));
    ASSERT_LT(glm::length(predictor.predict(400'000).eye), 0.01);
  }
}

TEST(CorePredictor, HalfTurnInOneSampleStaysFinite) {
  for (const double turn : {3.14159265358979, 3.1415, 3.15, 1e-9}) {
    Predictor predictor(kMaxSpeed);
    predictor.add(0, pose_at({0, 0, 0}, 0));
    predictor.add(kFrameUs, pose_at({0, 0, 0}, turn));
    const glm::quat q = predictor.predict(500'000).rotation;
    EXPECT_NEAR(glm::length(glm::dquat(q)), 1, 1e-6);
  }
}

TEST(CorePredictor, ErrorIsMeasuredWhenTheTimeComes) {
  Predictor predictor(kMaxSpeed);
  EXPECT_EQ(predictor.error().p95_m, 0);
  for (int i = 0; i < 600; ++i) {
    predictor.add(i * kFrameUs, pose_at({1.4 * 1e-6 * static_cast<double>(i * kFrameUs), 0, 0}));
    predictor.remember(6 * kFrameUs);
  }
  const PredictionError error = predictor.error();
  const double h = 6e-6 * kFrameUs;
  // The damping is the only error on a straight line.
  EXPECT_NEAR(error.p50_m, 1.4 * (h + 0.8 * std::expm1(-h / 0.8)), 1e-4);
  EXPECT_NEAR(error.p95_degrees, 0, 1e-3);
}

}  // namespace
}  // namespace mirage::test

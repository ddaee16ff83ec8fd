// Steering: how a person moves the eye.
#include "client/screen/steering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mirage::test {
namespace {

glm::dvec3 ahead(const Pose& pose) { return glm::dquat(pose.rotation) * glm::dvec3(0, 0, -1); }

TEST(ClientSteering, TurnsWithoutTilting) {
  Pose pose = look_at({1, 2, 3}, {1, 2, -7});
  steer(pose, {0.3, 0, {}});
  EXPECT_NEAR(std::atan2(ahead(pose).x, -ahead(pose).z), 0.3, 1e-5) << "to the right";
  steer(pose, {0, 0.2, {}});
  EXPECT_NEAR(std::asin(ahead(pose).y), -0.2, 1e-5) << "downwards";
  const glm::dvec3 right = glm::dquat(pose.rotation) * glm::dvec3(1, 0, 0);
  EXPECT_NEAR(right.y, 0, 1e-6);
  EXPECT_EQ(pose.eye, glm::dvec3(1, 2, 3));
}

TEST(ClientSteering, NeverOverTheTop) {
  Pose pose;
  for (int i = 0; i < 100; ++i) steer(pose, {0, -0.5, {}});
  EXPECT_NEAR(std::asin(ahead(pose).y), 1.5, 1e-3);
  steer(pose, {0, 100, {}});
  EXPECT_NEAR(std::asin(ahead(pose).y), -1.5, 1e-3);
}

TEST(ClientSteering, MovesWhereItLooks) {
  Pose pose = look_at({0, 0, 0}, {10, 0, 0});
  steer(pose, {0, 0, {1, 2, 3}});
  EXPECT_NEAR(glm::length(pose.eye - glm::dvec3(3, 2, 1)), 0, 1e-6);
}

TEST(ClientSteering, WhatIsNoNumberMovesNothing) {
  Pose pose = look_at({1, 2, 3}, {4, 5, 6});
  const Pose before = pose;
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    steer(pose, {wrong, 0, {}});
    steer(pose, {0, 0, {0, wrong, 0}});
  }
  EXPECT_EQ(pose.eye, before.eye);
  EXPECT_EQ(pose.rotation, before.rotation);
}

}  // namespace
}  // namespace mirage::test

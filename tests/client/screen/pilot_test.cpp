// Pilot: how a person moves the eye.
#include "client/screen/pilot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "client/scene/scene_view.h"

namespace mirage::test {
namespace {

constexpr double kFov = 1.0;
const GroundMap kNoGround;

glm::dvec3 ahead(const Pose& pose) { return glm::dquat(pose.rotation) * glm::dvec3(0, 0, -1); }

Steering turn_by(double right, double down) {
  Steering by;
  by.turn = {right, down};
  return by;
}
Steering drag_by(double right, double down) {
  Steering by;
  by.drag = {right, down};
  return by;
}
Steering move_by(const glm::dvec3& seconds) {
  Steering by;
  by.move = seconds;
  return by;
}

/// A scene around the origin, seen from `eye`.
SceneView scene_of(double radius, const glm::dvec3& eye, double walk_mps = 1.4) {
  SceneView scene;
  scene.bounds_radius = radius;
  scene.home.eye = eye;
  scene.home.target = {0, 0, 0};
  scene.home.walk_speed_mps = walk_mps;
  return scene;
}

Pilot pilot_in(const SceneView& scene) {
  Pilot pilot;
  pilot.meet(scene);
  return pilot;
}

/// Returns where the pivot is seen: right, up, ahead.
glm::dvec3 seen(const Pilot& pilot, const Pose& pose) {
  return glm::conjugate(glm::dquat(pose.rotation)) * (pilot.pivot() - pose.eye);
}

TEST(ClientPilot, TheHomeViewChoosesTheMode) {
  EXPECT_EQ(pilot_in(scene_of(1, {0, 0, 3})).mode(), SteerMode::kOrbit);
  EXPECT_EQ(pilot_in(scene_of(10, {0, 0, 3})).mode(), SteerMode::kWalk);
}

TEST(ClientPilot, WalkersTurnWithoutTilting) {
  Pilot pilot = pilot_in(scene_of(100, {1, 2, 3}));
  Pose pose = look_at({1, 2, 3}, {1, 2, -7});
  pilot.steer(turn_by(0.3, 0), kFov, kNoGround, pose);
  EXPECT_NEAR(std::atan2(ahead(pose).x, -ahead(pose).z), 0.3, 1e-5) << "to the right";
  pilot.steer(turn_by(0, 0.2), kFov, kNoGround, pose);
  EXPECT_NEAR(std::asin(ahead(pose).y), -0.2, 1e-5) << "downwards";
  const glm::dvec3 right = glm::dquat(pose.rotation) * glm::dvec3(1, 0, 0);
  EXPECT_NEAR(right.y, 0, 1e-6);
  EXPECT_EQ(pose.eye, glm::dvec3(1, 2, 3));
}

TEST(ClientPilot, ADragTakesTheWorldAlong) {
  Pilot walker = pilot_in(scene_of(100, {0, 0, 3}));
  Pose pose = look_at({0, 0, 3}, {0, 0, 0});
  walker.steer(drag_by(0.25, 0), kFov, kNoGround, pose);
  EXPECT_NEAR(std::atan2(ahead(pose).x, -ahead(pose).z), -0.25 * kFov, 1e-5)
      << "a quarter of the picture";
  EXPECT_EQ(pose.eye, glm::dvec3(0, 0, 3));

  Pilot orbiter = pilot_in(scene_of(1, {0, 0, 3}));
  pose = look_at({0, 0, 3}, {0, 0, 0});
  orbiter.steer(drag_by(0.1, 0), kFov, kNoGround, pose);
  EXPECT_LT(pose.eye.x, -0.5) << "what is in front of the pivot goes to the right";
  EXPECT_NEAR(glm::length(pose.eye), 3, 1e-5);
  orbiter.steer(drag_by(0, 0.1), kFov, kNoGround, pose);
  EXPECT_GT(pose.eye.y, 0.5) << "and down";
}

TEST(ClientPilot, AnOrbitKeepsThePivotWhereItIsSeen) {
  Pilot pilot = pilot_in(scene_of(1, {0, 0, 3}));
  pilot.aim({0.4, 0.3, 0.2});
  Pose pose = look_at({0, 0, 3}, {0, 0, 0});
  const glm::dvec3 before = seen(pilot, pose);
  for (const auto& [x, y] : {std::pair{0.3, 0.0}, {0.1, 0.2}, {-0.7, 0.9}, {0.2, -1.5}}) {
    pilot.steer(drag_by(x, y), kFov, kNoGround, pose);
    EXPECT_LT(glm::length(seen(pilot, pose) - before), 1e-4);
  }
}

TEST(ClientPilot, NeverOverTheTop) {
  for (const double radius : {1.0, 100.0}) {
    Pilot pilot = pilot_in(scene_of(radius, {0, 0, 3}));
    Pose pose = look_at({0, 0, 3}, {0, 0, 0});
    for (int i = 0; i < 100; ++i) pilot.steer(turn_by(0, -0.5), kFov, kNoGround, pose);
    EXPECT_NEAR(std::asin(ahead(pose).y), 1.5, 1e-3);
    pilot.steer(turn_by(0, 100), kFov, kNoGround, pose);
    EXPECT_NEAR(std::asin(ahead(pose).y), -1.5, 1e-3);
  }
}

TEST(ClientPilot, APanKeepsThePivotUnderTheHand) {
  Pilot pilot = pilot_in(scene_of(1, {0, 0, 3}));
  Pose pose = look_at({0, 0, 3}, {0, 0, 0});
  Steering by;
  by.pan = {0.25, -0.125};
  pilot.steer(by, kFov, kNoGround, pose);
  const glm::dvec3 at = seen(pilot, pose);
  const double height = 2 * std::tan(kFov / 2) * -at.z;
  EXPECT_NEAR(at.x / height, 0.25, 1e-6);
  EXPECT_NEAR(at.y / height, 0.125, 1e-6);
}

TEST(ClientPilot, StepsApproachThePivotAndNeverPassIt) {
  Pilot pilot = pilot_in(scene_of(1, {0, 0, 3}));
  Pose pose = look_at({0, 0, 3}, {0, 0, 0});
  Steering by;
  by.zoom = 1;
  double before = 3;
  for (int i = 0; i < 200; ++i, before = pose.eye.z) {
    pilot.steer(by, kFov, kNoGround, pose);
    EXPECT_LE(pose.eye.z, before);
    EXPECT_GT(pose.eye.z, 0);
  }
  by.zoom = -1;
  for (int i = 0; i < 400; ++i) pilot.steer(by, kFov, kNoGround, pose);
  EXPECT_NEAR(pose.eye.z, 20, 1e-3) << "nor go out of sight";
}

// A room in millimetres, a city in kilometres, a fox in centimetres; a forest in metres is walked
// through at the speed of its author.
TEST(ClientPilot, AnySceneIsCrossedInSeconds) {
  for (const SceneView& scene :
       {scene_of(5000, {0, 0, 10}), scene_of(1.5, {0, 0, 0.1}), scene_of(80, {0, 0, 200}),
        scene_of(1e-3, {0, 0, 3e-3}), scene_of(6.4e6, {0, 0, 1e7})}) {
    const double seconds = 2 * scene.bounds_radius / pilot_in(scene).speed_mps();
    EXPECT_GE(seconds, 5);
    EXPECT_LE(seconds, 20);
  }
  EXPECT_DOUBLE_EQ(pilot_in(scene_of(120, {0, 0, 20})).speed_mps(), 2.8);
}

TEST(ClientPilot, MovesWhereItLooks) {
  Pilot pilot = pilot_in(scene_of(100, {0, 0, 3}, 0.5));
  Pose pose = look_at({0, 0, 0}, {10, 0, 0});
  pilot.steer(move_by({1, 2, 3}), kFov, kNoGround, pose);
  EXPECT_NEAR(glm::length(pose.eye - pilot.speed_mps() * glm::dvec3(3, 2, 1)), 0, 1e-5);
}

// High above a city one flies far in a second; before a wall not through it. Who stands on the
// ground walks.
TEST(ClientPilot, WhoFliesIsFasterTheFartherTheyLook) {
  SceneView scene = scene_of(100, {0, 0, 3});
  ObjectDescription box;
  box.box_min = glm::vec3(-1);
  box.box_max = glm::vec3(1);
  box.radius = 1.8f;
  scene.objects = {box};
  InstanceView one;
  one.radius = 1.8;
  scene.instances = {one};
  const auto way_in_a_second = [&](double distance) {
    Pilot pilot = pilot_in(scene);
    pilot.set_flies(true);
    Camera camera;
    camera.width = camera.height = 100;
    camera.fov_y = kFov;
    camera.pose = look_at({0, 0, distance + 1}, {0, 0, 0});
    Pose pose = camera.pose;
    for (int i = 0; i < 300; ++i) {  // until the pace is reached
      pilot.look_ahead(scene, camera);
      pilot.steer(move_by({0, 0.01, 0}), kFov, kNoGround, pose);
    }
    const double from = pose.eye.y;
    pilot.steer(move_by({0, 1, 0}), kFov, kNoGround, pose);
    return pose.eye.y - from;
  };
  const double usual = pilot_in(scene).speed_mps();
  EXPECT_NEAR(way_in_a_second(5 * usual), usual, 0.01 * usual);
  EXPECT_NEAR(way_in_a_second(15 * usual), 3 * usual, 0.02 * usual);
  EXPECT_NEAR(way_in_a_second(1e6), 10 * usual, 0.1 * usual);
  EXPECT_NEAR(way_in_a_second(1e-3), 0.5 * usual, 0.01 * usual);
  scene.home.walk_eye_m = 1.6;  // a place with ground is walked, and flown through no slower
  EXPECT_NEAR(way_in_a_second(1e-3), usual, 0.01 * usual);
}

TEST(ClientPilot, WhatIsNoNumberMovesNothing) {
  Pilot pilot = pilot_in(scene_of(1, {0, 0, 3}));
  Pose pose = look_at({1, 2, 3}, {4, 5, 6});
  const Pose before = pose;
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    pilot.steer(turn_by(wrong, 0), kFov, kNoGround, pose);
    pilot.steer(move_by({0, wrong, 0}), kFov, kNoGround, pose);
    Steering by;
    by.zoom = wrong;
    pilot.steer(by, kFov, kNoGround, pose);
  }
  EXPECT_EQ(pose.eye, before.eye);
  EXPECT_EQ(pose.rotation, before.rotation);
}

TEST(ClientPilot, SeesTheNearestHullUnderAPlace) {
  SceneView scene = scene_of(10, {0, 0, 20});
  ObjectDescription box;
  box.box_min = glm::vec3(-1);
  box.box_max = glm::vec3(1);
  box.radius = 1.8f;
  scene.objects = {box};
  for (const double z : {-3.0, 0.0}) {
    InstanceView one;
    one.center = one.world_from_object.position = {0, 0, z};
    one.radius = 1.8;
    scene.instances.push_back(one);
  }
  Camera camera;
  camera.pose = look_at({0, 0, 20}, {0, 0, 0});
  camera.fov_y = kFov;
  camera.width = 200;
  camera.height = 100;
  const auto middle = seen_at(scene, camera, {0.5, 0.5});
  ASSERT_TRUE(middle);
  EXPECT_NEAR(glm::length(middle->point - glm::dvec3(0, 0, 1)), 0, 1e-5);
  EXPECT_EQ(middle->instance, 1u) << "the nearer one";
  EXPECT_FALSE(seen_at(scene, camera, {0.1, 0.1})) << "nothing is there";
  const auto above = seen_at(scene, camera, {0.5, 0.46});
  ASSERT_TRUE(above);
  EXPECT_GT(above->point.y, 0.5) << "places count downwards";
  camera.pose = look_at({0, 0, 0}, {0, 0, -10});
  const auto from_inside = seen_at(scene, camera, {0.5, 0.5});
  ASSERT_TRUE(from_inside);
  EXPECT_NEAR(from_inside->point.z, -2, 1e-5) << "the box around the eye does not count";
}

}  // namespace
}  // namespace mirage::test

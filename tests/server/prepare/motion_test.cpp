// Motion: measures of a clip also hold for poses that were not measured.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/impostor/error_bound.h"
#include "server/prepare/convex_hull.h"
#include "server/prepare/find_track.h"
#include "server/prepare/motion_measure.h"

namespace mirage {
namespace {

float uniform(std::mt19937& random, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(random);
}

struct Moving {
  Mesh mesh;
  Animation animation;
  std::vector<glm::vec3> at(double t) const {
    std::vector<glm::vec3> out;
    pose_positions(mesh.vertices, animation, t, out);
    return out;
  }
};

/// A chain of three joints with random keys of every kind, 30 vertices bound to it.
Moving random_clip(std::uint32_t seed) {
  std::mt19937 random(seed);
  Moving m;
  m.animation.clip_s = uniform(random, 0.3f, 5);
  m.animation.joints.resize(3);
  for (std::uint16_t j = 0; j < 3; ++j) {
    Joint& joint = m.animation.joints[j];
    joint.parent = j - 1;
    joint.moves = true;
    joint.translation = {uniform(random, -1, 1), 1, 0};
    m.animation.bindings.push_back({j, glm::mat4(1)});
    for (int kind = 0; kind < 3; ++kind) {
      Channel c;
      c.target = j;
      c.path = static_cast<ChannelPath>(kind);
      c.interpolation = static_cast<Interpolation>(random() % 3);
      const bool cubic = c.interpolation == Interpolation::kCubicSpline;
      const int keys = 2 + static_cast<int>(random() % 6);
      for (int k = 0; k < keys; ++k) {
        const float share =
            (static_cast<float>(k) + uniform(random, 0, 0.8f)) / static_cast<float>(keys);
        c.times.push_back(m.animation.clip_s * share);
        for (int part = 0; part < (cubic ? 3 : 1); ++part) {
          const bool tangent = cubic && part != 1;
          for (int i = 0; i < (kind == 1 ? 4 : 3); ++i) {
            const float value = uniform(random, -1, 1);
            c.values.push_back(tangent ? 0.5f * value : kind == 2 ? 1 + 0.3f * value : value);
          }
        }
      }
      m.animation.channels.push_back(c);
    }
  }
  for (std::uint32_t i = 0; i < 30; ++i) {
    Vertex v;
    v.position = {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
    m.mesh.vertices.push_back(v);
    m.mesh.indices.push_back(i);
    VertexBinding b;
    b.binding = {i % 3, (i + 1) % 3, 0, 0};
    b.weight = {0.7f, 0.3f, 0, 0};
    m.animation.vertices.push_back(b);
  }
  m.mesh.primitives.push_back({PrimitiveKind::kTriangles, 0, 30, 0});
  return m;
}

TEST(ServerMotion, BoundsEncloseEveryPose) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const Moving m = random_clip(seed);
    const MeasuredMotion measured = measure_motion(m.mesh, m.animation);
    const auto hull = enclosing_hull(measured.hull_points);
    ASSERT_TRUE(hull.ok());
    const std::vector<Plane> planes = hull->planes();
    std::mt19937 random(seed);
    for (int k = 0; k < 3000; ++k) {
      for (const glm::vec3& p : m.at(uniform(random, 0, m.animation.clip_s))) {
        ASSERT_LE(glm::distance(glm::dvec3(p), glm::dvec3(measured.center)), measured.radius);
        for (int c = 0; c < 3; ++c) {
          ASSERT_GE(p[c], measured.box_min[c]);
          ASSERT_LE(p[c], measured.box_max[c]);
        }
        for (const Plane& plane : planes)
          ASSERT_LE(glm::dot(plane.normal, glm::dvec3(p)), plane.offset);
      }
    }
  }
}

TEST(ServerMotion, NoVertexTravelsFartherThanTheProfileSays) {
  std::size_t checked = 0;
  double tightest = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const Moving m = random_clip(seed);
    const MotionProfile motion = measure_motion(m.mesh, m.animation).motion;
    std::mt19937 random(seed + 100);
    for (int k = 0; k < 3000; ++k) {
      const double a = uniform(random, 0, m.animation.clip_s);
      // Pairs are near and far alike: from 1e-6 of the clip to all of it.
      const double step = m.animation.clip_s * std::pow(10.0, uniform(random, -6, 0));
      const double b = wrap_clip(a + step, m.animation.clip_s);
      const double allowed = motion.travel(a, b);
      const std::vector<glm::vec3> from = m.at(a), to = m.at(b);
      for (std::size_t i = 0; i < from.size(); ++i) {
        const double moved = glm::distance(glm::dvec3(from[i]), glm::dvec3(to[i]));
        ASSERT_LE(moved, allowed + 2e-6) << seed << ": " << a << " to " << b;
        if (allowed > 1e-3) tightest = std::max(tightest, moved / allowed);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 1'000'000u);
  EXPECT_GT(tightest, 0.9) << "the profile is no use when it is far above the truth";
}

TEST(ServerMotion, ATurningArmHasItsSpeed) {
  Moving m;
  m.mesh.vertices.resize(1);
  m.mesh.vertices[0].position = {2, 0, 0};
  m.mesh.indices = {0};
  m.animation.clip_s = 1;
  m.animation.joints.resize(1);
  m.animation.joints[0].moves = true;
  m.animation.bindings.resize(1);
  m.animation.vertices.resize(1);
  Channel c;
  c.path = ChannelPath::kRotation;
  c.times = {0, 0.25f, 0.5f, 0.75f, 1};
  for (int k = 0; k < 5; ++k) {
    const float half = 0.78539816f * static_cast<float>(k);
    c.values.insert(c.values.end(), {0, 0, std::sin(half), std::cos(half)});
  }
  m.animation.channels = {c};
  const MeasuredMotion measured = measure_motion(m.mesh, m.animation);
  EXPECT_NEAR(measured.motion.max_speed(), 2 * 6.2831853, 0.06 * 2 * 6.2831853);
  EXPECT_GE(measured.motion.max_speed(), 2 * 6.2831853);
  EXPECT_NEAR(measured.motion.wrap_jump, 0, 1e-5);
  EXPECT_TRUE(measured.motion.jump.empty());
  EXPECT_NEAR(measured.radius, 2, 0.1);
}

// A scan on a turntable has no limit of vertices: it is measured by a body around it.
TEST(ServerMotion, ManyVerticesThatTurnRigidlyAreMeasuredByABodyAroundThem) {
  Moving m = random_clip(3);
  std::mt19937 random(3);
  m.mesh = Mesh();
  m.animation.vertices.clear();
  for (std::uint32_t i = 0; i < 200'000; ++i) {
    const glm::vec3 ball(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    m.mesh.vertices.emplace_back().position =
        glm::normalize(ball) + glm::vec3(static_cast<float>(i % 3));
    m.mesh.indices.push_back(i);
    m.animation.vertices.emplace_back().binding.x = static_cast<std::uint16_t>(i % 3);
  }
  ASSERT_TRUE(moves_rigidly(m.animation));
  const MeasuredMotion measured = measure_motion(m.mesh, m.animation);
  double farthest = 0, tightest = 0;
  for (int k = 0; k < 40; ++k) {
    const double a = uniform(random, 0, m.animation.clip_s);
    const double b = wrap_clip(a + 0.01 * m.animation.clip_s, m.animation.clip_s);
    const double allowed = measured.motion.travel(a, b);
    const std::vector<glm::vec3> from = m.at(a), to = m.at(b);
    for (std::size_t i = 0; i < from.size(); ++i) {
      const double moved = glm::distance(from[i], to[i]);
      ASSERT_LE(moved, allowed + 2e-6);
      if (allowed > 1e-3) tightest = std::max(tightest, moved / allowed);
      farthest = std::max(farthest, double{glm::distance(from[i], measured.center)});
    }
  }
  EXPECT_LE(farthest, measured.radius);
  EXPECT_GT(farthest, 0.7 * measured.radius) << "the body is too large";
  EXPECT_GT(tightest, 0.6) << "the profile is too far above the truth";
}

// Meshes that are shown in turn, each scaled to 0 in between.
TEST(ServerMotion, PosesWithoutExtentAreHidden) {
  Moving m = random_clip(1);
  for (int parent = -1; Joint & joint : m.animation.joints) joint = {.parent = parent++};
  m.animation.joints[0].moves = true;
  m.animation.clip_s = 4;
  Channel scale;
  scale.path = ChannelPath::kScale;
  scale.interpolation = Interpolation::kStep;
  scale.times = {0, 1, 2, 4};
  scale.values = {0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0};
  m.animation.channels = {scale};
  const MotionProfile motion = measure_motion(m.mesh, m.animation).motion;
  ASSERT_EQ(motion.hidden.size(), 32u);
  for (int pose = 0; pose < 256; ++pose) {
    const bool shown = pose >= 64 && pose < 128;
    EXPECT_EQ(motion.hides(static_cast<Phase>(pose + 1)), !shown) << pose;
  }
  EXPECT_TRUE(motion.hidden_at(0.9));
  EXPECT_FALSE(motion.hidden_at(1.1));
  EXPECT_FALSE(motion.hides(kStaticPhase));
  m.animation.channels[0].values = {1, 1, 1, 2, 2, 2, 1, 1, 1, 1, 1, 1};
  EXPECT_TRUE(measure_motion(m.mesh, m.animation).motion.hidden.empty());
}

/// A box of 4 m that drives 200 m in 20 s along x, and turns its wheel, a vertex, if `turns`.
SceneObject driving(bool turns) {
  SceneObject car;
  for (int i = 0; i < 8; ++i) {
    car.mesh.vertices.emplace_back().position = {i & 1 ? 2 : -2, i & 2 ? 1 : 0, i & 4 ? 1 : -1};
    car.mesh.indices.push_back(static_cast<std::uint32_t>(i));
  }
  Animation animation;
  animation.clip_s = 20;
  animation.joints.resize(2);
  animation.joints[0].moves = animation.joints[1].moves = true;
  animation.joints[1].parent = 0;
  animation.bindings = {{0, glm::mat4(1)}, {1, glm::mat4(1)}};
  animation.vertices.resize(8);
  if (turns) animation.vertices[7].binding.x = 1;
  Channel way;
  way.times = {0, 20};
  way.values = {-100, 0, 0, 100, 0, 0};
  Channel turn;
  turn.target = 1;
  turn.path = ChannelPath::kRotation;
  turn.times = {0, 10, 20};
  turn.values = {0, 0, 0, 1, 0, 0.1f, 0, 0.995f, 0, 0, 0, 1};
  animation.channels = {way, turn};
  car.animation = std::make_shared<const Animation>(animation);
  return car;
}

TEST(ServerMotion, AWayIsTakenOutOfThePoses) {
  for (const bool turns : {false, true}) {
    const SceneObject before = driving(turns);
    SceneObject car = before;
    EXPECT_NEAR(take_track(car), 200, 1e-3);
    ASSERT_TRUE(car.track.moves());
    const MeasuredMotion measured = measure_motion(car.mesh, *car.animation, 200);
    EXPECT_EQ(measured.motion.moving(), turns) << "a rigid car is static on its way";
    EXPECT_LT(measured.radius, 4);
    for (double t = 0; t < 20; t += 0.37) {
      std::vector<glm::vec3> whole, rest;
      pose_positions(before.mesh.vertices, *before.animation, t, whole);
      pose_positions(car.mesh.vertices, *car.animation, t, rest);
      const Similarity at = on_track({{7, 0, 0}, {1, 0, 0, 0}, 2}, car.track, t);
      for (std::size_t i = 0; i < whole.size(); ++i) {
        const glm::dvec3 world = at.position + 2.0 * glm::dvec3(rest[i]);
        EXPECT_LT(glm::distance(world, glm::dvec3(7, 0, 0) + 2.0 * glm::dvec3(whole[i])), 1e-4);
      }
    }
  }
}

TEST(ServerMotion, WhatStaysOrJumpsHasNoWay) {
  SceneObject near = driving(true);
  Animation animation = *near.animation;
  animation.channels[0].values = {-1, 0, 0, 1, 0, 0};
  near.animation = std::make_shared<const Animation>(animation);
  EXPECT_EQ(take_track(near), 0);
  EXPECT_FALSE(near.track.moves());
  animation.channels[0].values = {-100, 0, 0, 100, 0, 0};
  animation.channels[0].times = {0, 10.03f};
  animation.channels[0].interpolation = Interpolation::kStep;
  near.animation = std::make_shared<const Animation>(animation);
  EXPECT_EQ(take_track(near), 0);
}

TEST(ServerMotion, WhatMovesNoVertexIsStatic) {
  Moving m = random_clip(1);
  for (VertexBinding& v : m.animation.vertices) v.binding = glm::u16vec4(0);
  std::erase_if(m.animation.channels, [](const Channel& c) { return c.target == 0; });
  EXPECT_FALSE(measure_motion(m.mesh, m.animation).motion.moving());
  EXPECT_TRUE(measure_motion(random_clip(1).mesh, random_clip(1).animation).motion.moving());
}

// A million points of the ball move by `travel`: their images never part by more.
TEST(ServerMotion, ImageDistanceOfAStepIsBounded) {
  std::mt19937 random(3);
  const auto ball = [&](float radius) {
    for (;;) {
      const glm::dvec3 p(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
      if (glm::length(p) <= 1) return p * double{radius};
    }
  };
  double tightest = 0;
  for (int k = 0; k < 1'000'000; ++k) {
    ViewGeometry view;
    view.focal_px = 500;
    view.radius = 1;
    view.eye = glm::normalize(ball(1)) * double{uniform(random, 1.2f, 12)};
    const glm::dvec3 forward =
        glm::normalize(glm::normalize(-view.eye) + ball(0.5f));  // up to 30 degrees off
    view.center_depth = glm::dot(-view.eye, forward);
    const glm::dvec3 p = ball(1), q = ball(1);
    const double bound = motion_bound_px(view, glm::distance(p, q));
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0.3, 1, 0.2)));
    const glm::dvec3 up = glm::cross(right, forward);
    const double error =
        point_error_px(view.focal_px, p - view.eye, q - view.eye, forward, right, up);
    if (!std::isfinite(bound)) continue;
    ASSERT_LE(error, bound * (1 + 1e-9));
    tightest = std::max(tightest, error / bound);
  }
  EXPECT_GT(tightest, 0.5);
}

}  // namespace
}  // namespace mirage

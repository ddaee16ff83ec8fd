#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "protocol/base/limits.h"
#include "protocol/codec/animation_codec.h"
#include "protocol/codec/model_codec.h"
#include "protocol/impostor/motion.h"

namespace mirage {
namespace {

constexpr double kPi = 3.14159265358979323846;

Channel channel(ChannelPath path, Interpolation interpolation, std::vector<float> times,
                std::vector<float> values) {
  Channel c;
  c.path = path;
  c.interpolation = interpolation;
  c.times = std::move(times);
  c.values = std::move(values);
  return c;
}

glm::dvec3 sample3(const Channel& c, double t) {
  glm::dvec3 out;
  sample_channel(c, t, 3, &out.x);
  return out;
}

glm::dquat sample4(const Channel& c, double t) {
  double v[4];
  sample_channel(c, t, 4, v);
  return {v[3], v[0], v[1], v[2]};
}

/// A vertex at (1, 0, 0) on a joint that turns by a quarter about z in a second.
struct Turning {
  std::vector<Vertex> bind = std::vector<Vertex>(1);
  Animation animation;
  Turning() {
    bind[0].position = {1, 0, 0};
    bind[0].normal = {1, 0, 0};
    bind[0].tangent = {0, 1, 0, 1};
    animation.clip_s = 1;
    animation.joints.resize(1);
    animation.joints[0].moves = true;
    animation.bindings.resize(1);
    animation.vertices.resize(1);
    const float h = std::sqrt(0.5f);
    animation.channels = {
        channel(ChannelPath::kRotation, Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, 0, 0, h, h})};
  }
  Vertex at(double t) const {
    std::vector<Vertex> out;
    pose_vertices(bind, animation, t, out);
    return out[0];
  }
};

/// Returns one of everything: hierarchy, skin, morphs, all kinds of channels.
Animation sample_animation() {
  Animation a;
  a.clip_s = 2;
  a.joints.resize(3);
  a.joints[0].matrix[3] = {1, 2, 3, 1};
  a.joints[1].parent = 0;
  a.joints[1].moves = true;
  a.joints[2].parent = 1;
  a.joints[2].moves = true;
  a.bindings = {{1, glm::mat4(1)}, {2, glm::mat4(2)}};
  a.vertices.resize(4);
  a.vertices[1] = {{0, 1, 0, 0}, {0.75f, 0.25f, 0, 0}};
  MorphTarget target;
  target.vertex = {1, 3};
  target.position = {{1, 0, 0}, {0, 1, 0}};
  target.normal = target.tangent = {{0, 0, 0}, {0, 0, 1}};
  a.morphs = {{{0.5f}, {target}}};
  Channel turn =
      channel(ChannelPath::kRotation, Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0});
  turn.target = 1;
  Channel move = channel(ChannelPath::kTranslation, Interpolation::kStep, {0.5f}, {1, 2, 3});
  move.target = 2;
  a.channels = {
      turn, move,
      channel(ChannelPath::kWeights, Interpolation::kCubicSpline, {0, 2}, {0, 1, 0, 0, 2, 0})};
  return a;
}

TEST(ProtocolAnimation, StepHoldsAndEndsClamp) {
  const Channel c =
      channel(ChannelPath::kTranslation, Interpolation::kStep, {1, 2}, {1, 0, 0, 5, 0, 0});
  EXPECT_EQ(sample3(c, 0).x, 1);
  EXPECT_EQ(sample3(c, 1.999).x, 1);
  EXPECT_EQ(sample3(c, 2).x, 5);
  EXPECT_EQ(sample3(c, 99).x, 5);
}

TEST(ProtocolAnimation, LinearIsStraight) {
  const Channel c =
      channel(ChannelPath::kScale, Interpolation::kLinear, {0, 1, 3}, {0, 0, 0, 2, 4, 8, 4, 4, 4});
  EXPECT_NEAR(sample3(c, 0.25).y, 1.0, 1e-12);
  EXPECT_NEAR(sample3(c, 2).x, 3.0, 1e-12);
  EXPECT_NEAR(sample3(c, 2).z, 6.0, 1e-12);
}

// glTF appendix C by hand: v0 = 0, b0 = 1, v1 = 2, a1 = 0, td = 2, s = 1/2:
// p = 1/2 * 0 + 2 * 1/8 * 1 + 1/2 * 2 - 2 * 1/8 * 0 = 1.25
TEST(ProtocolAnimation, CubicMatchesTheSpecificationByHand) {
  const Channel c = channel(ChannelPath::kTranslation, Interpolation::kCubicSpline, {0, 2},
                            {9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 0, 0, 2, 0, 0, 9, 9, 9});
  EXPECT_NEAR(sample3(c, 1).x, 1.25, 1e-12);
  EXPECT_EQ(sample3(c, 0).x, 0);
  EXPECT_EQ(sample3(c, 2).x, 2);
}

TEST(ProtocolAnimation, RotationTakesTheShorterArcAtConstantSpeed) {
  const glm::dquat a(1, 0, 0, 0), b = glm::angleAxis(kPi / 2, glm::dvec3(0, 0, 1));
  for (const glm::dquat& end : {b, -b}) {
    const glm::dquat third = slerp_shortest(a, end, 1.0 / 3);
    EXPECT_NEAR(
        2 * std::atan2(glm::length(glm::dvec3(third.x, third.y, third.z)), std::abs(third.w)),
        kPi / 6, 1e-12);
  }
  // 1e-9 rad: acos of the dot product would find no angle at all.
  const glm::dquat tiny = glm::angleAxis(1e-9, glm::dvec3(1, 0, 0));
  EXPECT_NEAR(slerp_shortest(a, tiny, 0.5).x, 0.25e-9, 1e-15);
  const glm::dquat half_turn = slerp_shortest(a, glm::dquat(0, 0, 0, 1), 0.5);
  EXPECT_NEAR(glm::length(half_turn), 1, 1e-12);
}

TEST(ProtocolAnimation, QuaternionsWithoutLengthCountAsNoRotation) {
  const Channel c =
      channel(ChannelPath::kRotation, Interpolation::kLinear, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(sample4(c, 0.5), glm::dquat(1, 0, 0, 0));
  const Channel cubic = channel(ChannelPath::kRotation, Interpolation::kCubicSpline, {0},
                                std::vector<float>(12, 0.0f));
  EXPECT_EQ(sample4(cubic, 0.5), glm::dquat(1, 0, 0, 0));
}

TEST(ProtocolAnimation, PosesTurnPositionNormalAndTangent) {
  const Vertex v = Turning().at(1);
  EXPECT_NEAR(glm::distance(v.position, glm::vec3(0, 1, 0)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(v.normal, glm::vec3(0, 1, 0)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(glm::vec3(v.tangent), glm::vec3(-1, 0, 0)), 0, 1e-6);
  EXPECT_EQ(v.tangent.w, 1);
}

TEST(ProtocolAnimation, NormalsStayPerpendicularUnderUnevenScaleAndMirror) {
  Turning t;
  t.animation.channels.clear();
  t.animation.joints[0].scale = {2, 0.5f, -1};
  t.bind[0].normal = glm::normalize(glm::vec3(1, 1, 0));
  t.bind[0].tangent = glm::vec4(glm::normalize(glm::vec3(1, -1, 0)), 1);
  const Vertex v = t.at(0);
  EXPECT_NEAR(glm::dot(v.normal, glm::vec3(2, -0.5f, 0)), 0, 1e-6);  // the scaled tangent
  EXPECT_GT(v.normal.x + v.normal.y, 0);
  EXPECT_EQ(v.tangent.w, -1);
}

TEST(ProtocolAnimation, MorphsAddWeightTimesDisplacement) {
  Turning t;
  t.animation.channels.clear();
  MorphTarget target;
  target.vertex = {0};
  target.position = {{0, 0, 4}};
  target.normal = target.tangent = {glm::vec3(0)};
  t.animation.morphs = {{{0.25f}, {target}}};
  EXPECT_NEAR(t.at(0).position.z, 1, 1e-6);
}

TEST(ProtocolAnimation, PositionsAreThoseOfTheVertices) {
  const Animation a = sample_animation();
  std::vector<Vertex> bind(4), posed;
  for (std::size_t i = 0; i < 4; ++i) bind[i].position = glm::vec3(i, 1, 2);
  std::vector<glm::vec3> positions;
  pose_vertices(bind, a, 0.7, posed);
  pose_positions(bind, a, 0.7, positions);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(posed[i].position, positions[i]);
}

TEST(ProtocolAnimation, CodecRoundTrip) {
  const Animation a = sample_animation();
  const Bytes bytes = encode_animation(&a);
  EXPECT_EQ(bytes.size(), encoded_animation_bytes(&a));
  auto back = decode_animation(bytes.data(), bytes.size(), 4);
  ASSERT_TRUE(back.ok()) << back.error().line();
  EXPECT_EQ(encode_animation(back->get()), bytes);
  EXPECT_EQ((*back)->channels[2].values, a.channels[2].values);
  auto none = decode_animation(encode_animation(nullptr).data(), 1, 4);
  ASSERT_TRUE(none.ok());
  EXPECT_EQ(none->get(), nullptr);
}

TEST(ProtocolAnimation, HostileBytesAreRefusedOrPose) {
  const Animation a = sample_animation();
  const Bytes good = encode_animation(&a);
  for (std::size_t n = 0; n < good.size(); ++n) {
    EXPECT_FALSE(decode_animation(good.data(), n, 4).ok()) << n;
  }
  EXPECT_FALSE(decode_animation(good.data(), good.size(), 5).ok());  // of another mesh
  std::mt19937 random(7);
  std::vector<Vertex> bind(4), out;
  int decoded = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes bad = good;
    for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
    const auto read = decode_animation(bad.data(), bad.size(), 4);
    if (!read || *read == nullptr) continue;
    ++decoded;
    pose_vertices(bind, **read, 0.9, out);  // every index must be good
  }
  EXPECT_GT(decoded, 100);
}

TEST(ProtocolAnimation, EveryIndexAndNumberIsChecked) {
  const auto refused = [](auto change) {
    Animation a = sample_animation();
    change(a);
    const Bytes bytes = encode_animation(&a);
    return !decode_animation(bytes.data(), bytes.size(), 4).ok();
  };
  EXPECT_FALSE(refused([](Animation&) {}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refused([&](Animation& a) { a.clip_s = nan; }));
  EXPECT_TRUE(refused([](Animation& a) { a.clip_s = 0; }));
  EXPECT_TRUE(refused([](Animation& a) { a.joints[1].parent = 1; }));
  EXPECT_TRUE(refused([&](Animation& a) { a.joints[0].matrix[2][1] = nan; }));
  EXPECT_TRUE(refused([](Animation& a) { a.bindings[1].joint = 3; }));
  EXPECT_TRUE(refused([](Animation& a) { a.vertices[2].binding.w = 2; }));
  EXPECT_TRUE(refused([&](Animation& a) { a.vertices[2].weight.w = nan; }));
  EXPECT_TRUE(refused([](Animation& a) { a.morphs[0].targets[0].vertex[1] = 4; }));
  EXPECT_TRUE(refused([](Animation& a) { a.channels[0].target = 3; }));
  EXPECT_TRUE(refused([](Animation& a) { a.channels[2].target = 1; }));
  EXPECT_TRUE(refused([](Animation& a) { a.channels[0].times = {1, 1}; }));
  EXPECT_TRUE(refused([&](Animation& a) { a.channels[0].values[3] = nan; }));
  EXPECT_TRUE(refused([](Animation& a) { a.channels[0].values.pop_back(); }));
}

TEST(ProtocolAnimation, TravelsWithTheModel) {
  ObjectModel model;
  model.mesh.vertices.resize(4);
  // Equal vertices, used out of order: a mesh codec that joins or moves them breaks the bindings.
  for (std::size_t i = 0; i < 4; ++i) model.mesh.vertices[i].position.x = i == 2 ? 1.0f : 0.0f;
  model.mesh.indices = {3, 2, 0};
  model.mesh.primitives = {{PrimitiveKind::kTriangles, 0, 3, 0}};
  model.materials.resize(1);
  model.animation = std::make_shared<const Animation>(sample_animation());
  const Bytes bytes = encode_model(model);
  auto back = decode_model(bytes.data(), bytes.size(), 0);
  ASSERT_TRUE(back.ok()) << back.error().line();
  ASSERT_NE(back->animation, nullptr);
  EXPECT_EQ(encode_animation(back->animation.get()), encode_animation(model.animation.get()));
  ASSERT_EQ(back->mesh.vertices.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(back->mesh.vertices[i].position.x, model.mesh.vertices[i].position.x);
  }
}

TEST(ProtocolMotion, ClipsRepeat) {
  EXPECT_NEAR(wrap_clip(5.5, 2), 1.5, 1e-12);
  EXPECT_NEAR(wrap_clip(-0.5, 2), 1.5, 1e-12);
  EXPECT_EQ(wrap_clip(2, 2), 0);
  EXPECT_EQ(wrap_clip(1, 0), 0);
  EXPECT_EQ(wrap_clip(std::numeric_limits<double>::quiet_NaN(), 2), 0);
  EXPECT_LT(wrap_clip(-1e-18, 2), 2);
}

TEST(ProtocolMotion, PhasesOfCoarserLevelsAreASubset) {
  for (int level = 0; level <= limits::kMaxPhaseLevel; ++level) {
    for (int i = 0; i < 1 << level; ++i) {
      const double t = 3.0 * i / (1 << level);
      const Phase phase = nearest_phase(t, 3.0, level);
      EXPECT_TRUE(valid_phase(phase, true));
      EXPECT_NEAR(phase_time(phase, 3.0), t, 1e-12);
      EXPECT_EQ(nearest_phase(t, 3.0, limits::kMaxPhaseLevel), phase);
    }
  }
  EXPECT_EQ(nearest_phase(2.999, 3.0, 2), 1);  // the end is nearest to the beginning
  EXPECT_FALSE(valid_phase(0, true));
  EXPECT_FALSE(valid_phase(257, true));
  EXPECT_TRUE(valid_phase(256, true));
  EXPECT_TRUE(valid_phase(0, false));
  EXPECT_FALSE(valid_phase(1, false));
}

MotionProfile uneven() {
  MotionProfile m;
  m.clip_s = 64;  // a second for each segment
  m.speed.assign(64, 0.0f);
  m.speed[10] = 2;
  m.jump.assign(256, 0.0f);
  m.jump[82] = 5;  // at 20.5 to 20.75 s
  m.wrap_jump = 1;
  return m;
}

TEST(ProtocolMotion, TravelIsTheShorterWayRound) {
  const MotionProfile m = uneven();
  EXPECT_EQ(m.travel(3, 3), 0);
  EXPECT_EQ(m.travel(1, 9), 0);
  EXPECT_NEAR(m.travel(10.25, 10.75), 1, 1e-6);
  EXPECT_NEAR(m.travel(10.75, 10.25), 1, 1e-6);
  EXPECT_NEAR(m.travel(9, 12), 2, 1e-6);
  EXPECT_NEAR(m.travel(19, 22), 3, 1e-6);  // across the end (1) and segment 10 (2), not 5
  EXPECT_NEAR(m.travel(60, 2), 1, 1e-6);
  EXPECT_EQ(m.travel(20, 20.4), 0) << "on this side of the jump";
  EXPECT_EQ(m.max_speed(), 2);
  EXPECT_EQ(MotionProfile{}.travel(0, 1), 0);
}

// A mesh that is shown for a twelfth of the clip only. Both ends of half a clip look the same.
TEST(ProtocolMotion, APoseBetweenEqualOnesHasAPhaseOfItsOwn) {
  MotionProfile shown;
  shown.clip_s = 6;
  shown.speed.assign(limits::kMotionSegments, 0.0f);
  shown.jump.assign(256, 0.0f);
  shown.jump[21] = shown.jump[42] = 1;  // at 0.5 and 1 s
  EXPECT_EQ(shown.travel(0, 3), 0);
  EXPECT_EQ(shown.travel_onward(0, 3), 2);
  EXPECT_EQ(shown.travel_onward(3, 0), 0);
  for (const double t : {0.53, 0.6, 0.75, 0.9, 0.95}) {
    const Phase phase = nearest_phase(t, 6, phase_level_for(shown, t, 0.01));
    EXPECT_GT(phase_time(phase, 6), 0.5) << t;
    EXPECT_LT(phase_time(phase, 6), 1) << t;
  }
}

TEST(ProtocolMotion, PhaseLevelsFollowTheErrorPerSecond) {
  MotionProfile steady;
  steady.clip_s = 1;
  steady.speed.assign(64, 1.0f);
  int last = -1;
  for (const double distance : {1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 1e-9}) {
    const int level = phase_level_for(steady, 0.37, distance);
    EXPECT_GE(level, last);
    if (level < limits::kMaxPhaseLevel) {
      EXPECT_LE(0.5 / (1 << level), distance * 1.0001);
    }
    if (level > 0) {
      EXPECT_GT(0.5 / (1 << (level - 1)), distance);
    }
    last = level;
  }
  EXPECT_EQ(last, limits::kMaxPhaseLevel);
  MotionProfile still = steady;
  still.speed.assign(64, 0.0f);
  EXPECT_EQ(phase_level_for(still, 0.37, 1e-9), 0);
}

TEST(ProtocolMotion, CopiesAreSpreadOverTheClip) {
  int quarter[4] = {};
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const float offset = copy_offset(i, 4.0);
    ASSERT_TRUE(offset >= 0 && offset <= 4);
    ++quarter[std::min(3, static_cast<int>(offset))];
  }
  for (const int n : quarter) EXPECT_NEAR(n, 1000, 150);
}

}  // namespace
}  // namespace mirage

// Light probes: their texels, their encoding, and their part in a lighting state.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/impostor/light_probe.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/wire/light_probe_codec.h"
#include "tests/support/protocol_samples.h"

namespace mirage::test {
namespace {

LightProbe noisy_probe() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-8.0f, 8.0f);
  LightProbe probe;
  for (glm::vec3& c : probe.irradiance) c = {any(random), any(random), any(random)};
  for (std::size_t i = 0; i < kProbeTexels; ++i) {
    probe.texels.push_back(
        pack_shared_exponent(glm::exp2(glm::vec3(any(random), any(random), any(random)))));
  }
  probe.id = probe_id(probe);
  return probe;
}

Message sent(const LightProbe& probe) {
  const Bytes bytes = encode_probe(probe);
  return decode_message(bytes.data(), bytes.size()).take();
}

Lighting probe_light(std::uint64_t id) {
  Lighting lighting;
  lighting.ambient = glm::vec3(0);
  lighting.probe.id = id;
  return lighting;
}

std::uint64_t probe_hash(const Lighting& lighting, const glm::quat& turned = {1, 0, 0, 0}) {
  Similarity m;
  m.rotation = turned;
  return object_lighting(lighting, m, glm::vec3(0), 1).hash();
}

TEST(ProtocolProbe, TexelsKeepNineBitsOfTheBrightestChannel) {
  for (const float v : {0.0f, 1e-6f, 0.1f, 0.99f, 1.0f, 511.5f, 512.0f, 65408.0f}) {
    for (const glm::vec3 c : {glm::vec3(v), glm::vec3(v, 0.5f * v, 0.01f * v)}) {
      const glm::vec3 back = unpack_shared_exponent(pack_shared_exponent(c));
      const float step = std::max(v / 512.0f, 1.0f / 32768 / 512);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(back[i], c[i], 1.001f * step) << v;
    }
  }
  const glm::vec3 most = unpack_shared_exponent(pack_shared_exponent(glm::vec3(1e9f, -1, 0)));
  EXPECT_EQ(most, glm::vec3(65408, 0, 0));
}

TEST(ProtocolProbe, ComesBackAsItWas) {
  const LightProbe probe = noisy_probe();
  const Message message = sent(probe);
  const Result<LightProbe> back = decode_probe(*message.body.AsLightProbePage(), message.payload);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->id, probe.id);
  EXPECT_EQ(back->texels, probe.texels);
  EXPECT_EQ(back->irradiance, probe.irradiance);
}

TEST(ProtocolProbe, WhatIsNotItsContentIsRefused) {
  Message message = sent(noisy_probe());
  wire::LightProbePageT& page = *message.body.AsLightProbePage();
  const Bytes half(
      message.payload.begin(),
      message.payload.begin() + static_cast<std::ptrdiff_t>(message.payload.size() / 2));
  EXPECT_FALSE(decode_probe(page, half));
  EXPECT_FALSE(decode_probe(page, {}));
  page.irradiance[4] += 1;
  EXPECT_EQ(decode_probe(page, message.payload).error().id, ErrorId::kWireValue);
  page.irradiance[4] = std::nanf("");
  const Bytes nan = encode_body(message.body, message.payload);
  EXPECT_EQ(decode_message(nan.data(), nan.size()).error().id, ErrorId::kWireValue);
  page.irradiance.resize(26);
  const Bytes few = encode_body(message.body, message.payload);
  EXPECT_EQ(decode_message(few.data(), few.size()).error().id, ErrorId::kWireValue);
}

TEST(ProtocolProbe, IsInTheKeyAsTheObjectSeesIt) {
  const Lighting lighting = probe_light(0x123456789abcdefull);
  EXPECT_NE(probe_hash(lighting), probe_hash(probe_light(0)));
  EXPECT_NE(probe_hash(lighting), probe_hash(probe_light(0x123456789abcdeeull)));
  EXPECT_NE(probe_hash(lighting), probe_hash(probe_light(0x023456789abcdefull)));
  Lighting brighter = lighting;
  brighter.probe.strength = 1.5f;
  EXPECT_NE(probe_hash(brighter), probe_hash(lighting));
  EXPECT_FALSE(same_lighting(brighter, lighting));

  const glm::quat turn = glm::normalize(glm::quat(0.8f, 0.1f, 0.5f, -0.3f));
  EXPECT_NE(probe_hash(lighting, turn), probe_hash(lighting));
  Lighting turned = lighting;
  turned.probe.rotation = turn;
  EXPECT_EQ(probe_hash(turned, turn), probe_hash(lighting)) << "turned together";
  EXPECT_EQ(probe_hash(turned, -turn), probe_hash(lighting)) << "the same rotation";
}

TEST(ProtocolProbe, OneThatDoesNotShineIsNone) {
  Lighting dark = probe_light(17);
  dark.probe.strength = 0;
  dark.probe.rotation = glm::normalize(glm::quat(1, 2, 3, 4));
  EXPECT_EQ(probe_hash(dark), probe_hash(probe_light(0)));
  EXPECT_TRUE(same_lighting(dark, probe_light(0)));
  EXPECT_EQ(lighting_hash(dark), lighting_hash(probe_light(0)));
  EXPECT_NE(lighting_hash(probe_light(17)), lighting_hash(probe_light(0)));
}

TEST(ProtocolProbe, RotationsAndStrengthsAreChecked) {
  Lighting bad = probe_light(17);
  bad.probe.strength = -1;
  EXPECT_FALSE(checked_lighting(bad));
  bad.probe.strength = 1;
  bad.probe.rotation = glm::quat(2, 0, 0, 0);
  EXPECT_FALSE(checked_lighting(bad));
  bad.probe.rotation = glm::quat(std::nanf(""), 0, 0, 0);
  EXPECT_FALSE(checked_lighting(bad));
}

// White all around is 1 on every side; the map's margins repeat what is behind its folds.
TEST(ProtocolProbe, DirectionsCoverTheSphere) {
  LightProbe white;
  white.irradiance[0] = glm::vec3(1);
  EXPECT_EQ(irradiance_over_pi(white, {0, 0, 1}), glm::vec3(1));
  EXPECT_NEAR(probe_direction(0.5, 0.5).y, 1, 1e-12);
  EXPECT_NEAR(probe_direction(0, 0).y, -1, 1e-12);
  EXPECT_NEAR(probe_direction(1, 0.5).x, 1, 1e-12);
  for (const double along : {0.1, 0.4, 0.8}) {
    for (const double beyond : {-0.01, 1.01}) {
      const double inside = beyond < 0 ? 0.01 : 0.99;
      EXPECT_LT(glm::distance(probe_direction(beyond, along), probe_direction(inside, 1 - along)),
                1e-12);
    }
  }
}

}  // namespace
}  // namespace mirage::test

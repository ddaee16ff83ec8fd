// Surroundings: good and bad files, the built-in ones, and the results of prefiltering.
#include "server/scene/environment/environment.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "server/scene/environment/builtin_environment.h"
#include "server/scene/environment/environment_file.h"
#include "server/scene/environment/probe_filter.h"
#include "server/scene/environment/studio_probe.h"
#include "tests/support/temp_folder.h"

namespace mirage::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

Equirect filled(int width, int height, const std::function<glm::dvec3(const glm::dvec3&)>& at) {
  Equirect out{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) out.texels.emplace_back(at(equirect_direction(out, x, y)));
  }
  return out;
}

glm::vec3 texel(const LightProbe& probe, const ProbeLevel& level, int x, int y) {
  return unpack_shared_exponent(
      probe.texels[static_cast<std::size_t>((level.y + y) * kProbeWidth + level.x + x)]);
}

// Returns irradiance over pi by its definition.
glm::dvec3 irradiance_of(const Equirect& image, const glm::dvec3& normal) {
  glm::dvec3 sum(0);
  for (int y = 0; y < image.height; ++y) {
    const double area =
        (std::cos(kPi * y / image.height) - std::cos(kPi * (y + 1) / image.height)) * 2 * kPi /
        image.width;
    for (int x = 0; x < image.width; ++x) {
      const double cosine = glm::dot(equirect_direction(image, x, y), normal);
      if (cosine > 0) sum += area * cosine / kPi * glm::dvec3(image.at(x, y));
    }
  }
  return sum;
}

std::vector<glm::dvec3> around() {
  std::vector<glm::dvec3> out;
  for (int i = 0; i < 60; ++i) {
    const double y = 1 - (2.0 * i + 1) / 60, r = std::sqrt(1 - y * y), a = 2.4 * i;
    out.emplace_back(r * std::cos(a), y, r * std::sin(a));
  }
  return out;
}

TEST(Environment, TheSameFromAllSidesStaysSo) {
  const LightProbe probe =
      make_probe(filled(64, 32, [](const glm::dvec3&) { return glm::dvec3(0.5, 1, 2); }), {});
  for (const ProbeLevel& level : kProbeLevels) {
    for (const auto& [x, y] : {std::pair{0, 0}, {level.edge / 2, 1}, {level.edge - 1, 7}}) {
      const glm::vec3 t = texel(probe, level, x, y);
      EXPECT_NEAR(t.r, 0.5, 0.004) << level.edge;
      EXPECT_NEAR(t.b, 2, 0.004) << level.edge;
    }
  }
  for (const glm::dvec3& n : around()) {
    EXPECT_NEAR(irradiance_over_pi(probe, n).g, 1, 1e-3);
  }
}

TEST(Environment, RoughLevelsSpreadALampAndKeepItsPlace) {
  const glm::dvec3 lamp = glm::normalize(glm::dvec3(0.3, 0.5, -0.8));
  const Equirect image = filled(512, 256, [&](const glm::dvec3& d) {
    return glm::dvec3(glm::dot(d, lamp) > 0.995 ? 40 : 0);
  });
  const LightProbe probe = make_probe(image, {});
  float before = 1e9f;
  for (const ProbeLevel& level : kProbeLevels) {
    float most = 0;
    glm::dvec3 at(0);
    for (int y = 1; y < level.edge - 1; ++y) {
      for (int x = 1; x < level.edge - 1; ++x) {
        const float v = texel(probe, level, x, y).r;
        if (v <= most) continue;
        most = v;
        at = probe_direction((x - 0.5) / (level.edge - 2), (y - 0.5) / (level.edge - 2));
      }
    }
    EXPECT_LT(most, before) << level.edge;
    EXPECT_GT(glm::dot(at, lamp), 0.95) << level.edge;
    before = most;
  }
}

TEST(Environment, ThreadsChangeNothing) {
  const Equirect image = *builtin_environment("sky");
  EXPECT_EQ(make_probe(image, {}).texels, make_probe(image, Workers(3)).texels);
}

TEST(Environment, TheBuildKeepsTheStudiosProbe) {
  const LightProbe made = make_probe(*builtin_environment("studio"), {}), kept = studio_probe();
  EXPECT_EQ(kept.texels, made.texels);
  EXPECT_EQ(kept.irradiance, made.irradiance);
  EXPECT_EQ(kept.id, made.id);
}

// The neutral studio promises a white diffuse of about 0.8 without clipping. The harmonics match
// what they represent.
TEST(Environment, StudioIsExposedForWhite) {
  const Equirect studio = *builtin_environment("studio");
  const LightProbe probe = make_probe(studio, {});
  double most = 0, sum = 0, seen = 0;
  for (const glm::dvec3& n : around()) {
    const double exact = irradiance_of(studio, n).g, taken = irradiance_over_pi(probe, n).g;
    EXPECT_NEAR(taken, exact, 0.03);
    most = std::max(most, taken);
    if (n.y < -0.3) continue;
    sum += taken;
    ++seen;
  }
  EXPECT_NEAR(sum / seen, 0.8, 0.05);
  EXPECT_LT(most, 0.98);
}

struct EnvironmentFiles : ::testing::Test {
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  std::string image(const std::string& name, int w, int h, const std::vector<float>& pixels) const {
    auto output = OIIO::ImageOutput::create(path(name));
    EXPECT_TRUE(output->open(path(name), OIIO::ImageSpec(w, h, 3, OIIO::TypeDesc::FLOAT)));
    EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
    output->close();
    return path(name);
  }
  std::string text(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }
  ErrorId refused(const std::string& file) {
    const Result<Equirect> read = read_environment(file, warnings);
    EXPECT_FALSE(read) << file;
    return read ? ErrorId::kInternal : read.error().id;
  }
  TempFolder folder;
  std::vector<std::string> warnings;
};

TEST_F(EnvironmentFiles, GoodOnesAreRead) {
  const std::vector<float> pixels(3 * 32 * 16, 0.25f);
  for (const char* name : {"a.hdr", "b.exr"}) {
    const Result<Equirect> read = read_environment(image(name, 32, 16, pixels), warnings);
    ASSERT_TRUE(read) << name;
    EXPECT_EQ(read->width, 32);
    EXPECT_NEAR(read->at(31, 15).g, 0.25f, 0.002f);
  }
  EXPECT_TRUE(warnings.empty());
  ASSERT_TRUE(write_environment(*builtin_environment("studio"), path("studio.hdr")));
  EXPECT_TRUE(read_environment(path("studio.hdr"), warnings));
}

TEST_F(EnvironmentFiles, LargeOnesAreReduced) {
  const std::vector<float> pixels(3 * 4096 * 2048, 0.5f);
  const Result<Equirect> read = read_environment(image("4k.hdr", 4096, 2048, pixels), warnings);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->width, 1024);
  EXPECT_EQ(read->texels.size(), 1024u * 512);
  EXPECT_NEAR(read->at(1023, 511).r, 0.5f, 0.004f);
}

TEST_F(EnvironmentFiles, BadOnesAreRefusedByName) {
  EXPECT_EQ(refused(path("missing.hdr")), ErrorId::kSceneMissing);
  EXPECT_EQ(refused(folder.path().string()), ErrorId::kSceneMissing);
  EXPECT_EQ(refused(text("empty.hdr", "")), ErrorId::kSceneFormat);
  EXPECT_EQ(refused(text("words.exr", "this is no picture")), ErrorId::kSceneFormat);
  EXPECT_EQ(refused(text("words.txt", "nor is this")), ErrorId::kSceneFormat);
  std::filesystem::rename(image("true.hdr", 4, 2, std::vector<float>(3 * 4 * 2, 0.5f)),
                          path("no.exr"));
  EXPECT_EQ(refused(path("no.exr")), ErrorId::kSceneFormat) << "another format than its name says";
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  EXPECT_EQ(refused(text("16k.hdr", header + "-Y 8192 +X 16384\n")), ErrorId::kSceneLimit);
  EXPECT_EQ(refused(text("huge.hdr", header + "-Y 2000000000 +X 2000000000\n")),
            ErrorId::kSceneLimit);
  EXPECT_EQ(refused(text("none.hdr", header + "-Y 0 +X 0\n")), ErrorId::kSceneFormat);
  EXPECT_EQ(refused(text("negative.hdr", header + "-Y -4 +X 8\n")), ErrorId::kSceneFormat);
  const std::string whole = image("whole.hdr", 64, 32, std::vector<float>(3 * 64 * 32, 0.5f));
  std::ifstream in(whole, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  for (const std::size_t kept : {bytes.size() / 2, bytes.size() - 3, std::size_t{40}}) {
    EXPECT_EQ(refused(text("cut.hdr", bytes.substr(0, kept))), ErrorId::kSceneFormat) << kept;
  }
}

TEST_F(EnvironmentFiles, WhatIsNoColourIsCounted) {
  std::vector<float> pixels(3 * 8 * 4, 0.5f);
  pixels[0] = std::nanf("");
  pixels[4] = INFINITY;
  pixels[8] = -3;
  const Result<Equirect> read = read_environment(image("nan.exr", 8, 4, pixels), warnings);
  ASSERT_TRUE(read);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("3 pixels"), std::string::npos) << warnings[0];
  for (const glm::vec3& c : read->texels) {
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(c[i] >= 0 && c[i] <= 65408);
  }
}

TEST_F(EnvironmentFiles, OnePixelIsTheSameFromAllSides) {
  const Result<Equirect> read =
      read_environment(image("one.hdr", 1, 1, {0.5f, 0.5f, 0.5f}), warnings);
  ASSERT_TRUE(read);
  EXPECT_EQ(warnings.size(), 1u) << "not 2:1";
  const LightProbe probe = make_probe(*read, {});
  EXPECT_NEAR(irradiance_over_pi(probe, {0, 1, 0}).g, 0.5, 0.01);
}

Scene plain_scene(bool own_lights, bool unlit) {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].unlit = unlit;
  scene.lighting.lights.resize(1);
  scene.own_lights = own_lights;
  return scene;
}

TEST(EnvironmentOfAScene, TakesThePlaceOfWhatNobodySaid) {
  Scene bare = plain_scene(false, false);
  ASSERT_TRUE(set_environment("", bare, {}));
  ASSERT_TRUE(bare.probe);
  EXPECT_EQ(bare.lighting.probe.id, bare.probe->id);
  EXPECT_TRUE(bare.lighting.lights.empty());
  EXPECT_EQ(bare.lighting.ambient, glm::vec3(0));

  Scene lit = plain_scene(true, false);
  ASSERT_TRUE(set_environment("", lit, {}));
  EXPECT_FALSE(lit.probe);
  ASSERT_TRUE(set_environment("builtin:sky", lit, {}));
  EXPECT_TRUE(lit.probe);
  EXPECT_EQ(lit.lighting.lights.size(), 1u);

  Scene none = plain_scene(false, false);
  ASSERT_TRUE(set_environment("none", none, {}));
  EXPECT_FALSE(none.probe);
  EXPECT_EQ(none.lighting.lights.size(), 1u);

  Scene unlit = plain_scene(false, true);
  ASSERT_TRUE(set_environment("", unlit, {}));
  EXPECT_FALSE(unlit.probe) << "nothing reads it";

  Scene wrong = plain_scene(false, false);
  EXPECT_EQ(set_environment("builtin:nowhere", wrong, {}).error().id, ErrorId::kUsage);
}

TEST(Environment, OnlyWhatTheStudioLightsIsShownInOne) {
  const auto shown = [](bool studio, const std::string& spec, bool own_lights) {
    Scene scene;
    scene.own_lights = own_lights;
    scene.environment.floor.half = 1;
    set_look(studio, spec, scene);
    return scene.environment;
  };
  for (const char* spec : {"", "builtin:studio"}) {
    const mirage::Environment look = shown(true, spec, false);
    EXPECT_EQ(look.tone, ToneCurve::kNeutral);
    EXPECT_EQ(look.floor.half, 1);
    EXPECT_GT(look.floor.color.r, 0);
    EXPECT_NE(look.horizon, look.zenith);
  }
  for (const mirage::Environment& plain :
       {shown(false, "", false), shown(true, "builtin:sky", false), shown(true, "none", false),
        shown(true, "", true)}) {
    EXPECT_EQ(plain.tone, ToneCurve::kClip);
    EXPECT_EQ(plain.floor.half, 0);
    EXPECT_EQ(plain.horizon, mirage::Environment().horizon);
  }
}

}  // namespace
}  // namespace mirage::test

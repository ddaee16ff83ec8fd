// Every variant of the mesh shader compiles, even those that few scenes need.

#include <gtest/gtest.h>

#include "protocol/model/need_mask.h"
#include "tests/gl/bench.h"

namespace mirage::test {
namespace {

constexpr NeedMask kNeeds[] = {
    kNeedLighting,    kNeedBaseColorMap, kNeedMetalRoughMap, kNeedNormalMap,   kNeedOcclusionMap,
    kNeedEmissiveMap, kNeedAlphaMask,    kNeedBlend,         kNeedVertexColor, kNeedReflectance,
    kNeedClearcoat,   kNeedSheen,        kNeedTransmission,  kNeedAnisotropy,  kLobeMapNeeds};

TEST(Shaders, EveryVariantCompiles) {
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  ASSERT_TRUE(egl);
  std::vector<NeedMask> masks = {0};
  NeedMask all = 0;
  for (const NeedMask need : kNeeds) {
    masks.push_back(need | kNeedLighting);
    masks.push_back(all |= need);
  }
  const gl::ShadowMap map = gl::ShadowMap::create(16).take();
  const gl::ProbeMap probe = gl::ProbeMap::black();
  using gl::MeshOutput;
  for (const MeshOutput output : {MeshOutput::kColor, MeshOutput::kId, MeshOutput::kSurface,
                                  MeshOutput::kShadow, MeshOutput::kDepth, MeshOutput::kFront,
                                  MeshOutput::kRange, MeshOutput::kBehind, MeshOutput::kClear}) {
    for (const auto& [shadows, fog, light] : {std::tuple{false, 0.0f, false},
                                              {false, 0.01f, false},
                                              {true, 0.0f, true},
                                              {true, 0.01f, false},
                                              {false, 0.0f, true}}) {
      // Shadow tiles without a shadow map do not exist.
      if (output == MeshOutput::kShadow && !shadows) continue;
      gl::MeshPass pass(output);
      pass.set_fog(glm::vec3(1), fog);
      pass.set_shadow(shadows ? &map : nullptr, {});
      pass.set_probe(light ? &probe : nullptr);
      for (const NeedMask mask : masks) {
        const Result<void> compiled = pass.compile(mask, true);
        EXPECT_TRUE(compiled) << compiled.error().line();
      }
    }
  }
}

TEST(Shaders, FadingGeometryKeepsItsShareOfThePixels) {
  const auto bench = Bench::create("builtin:knot", BenchLight::kLit);
  ASSERT_TRUE(bench);
  const Camera camera = bench->camera(4, glm::dvec3(0, 0, 1));
  const auto covered = [&](float fade) {
    const std::vector<std::uint8_t> drawn = bench->mesh_picture(camera, fade);
    int count = 0;
    for (std::size_t i = 0; i + 3 < drawn.size(); i += 4) {
      count += std::abs(int{drawn[i]} - 128) > 1 || std::abs(int{drawn[i + 2]} - 128) > 1;
    }
    return static_cast<double>(count);
  };
  const double whole = covered(1);
  ASSERT_GT(whole, 10'000);
  EXPECT_NEAR(covered(0.5f) / whole, 0.5, 0.05);
  EXPECT_EQ(covered(0), 0);
}

}  // namespace
}  // namespace mirage::test

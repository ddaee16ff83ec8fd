// Light probe: light from all around, in drawing.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "server/prove/need_proof.h"
#include "server/render/gpu_scene.h"
#include "server/render/tile_shot.h"
#include "server/scene/environment/builtin_environment.h"
#include "server/scene/environment/probe_filter.h"
#include "shaders/gl/egl_context.h"
#include "tests/gl/need_scenes.h"

namespace mirage::test {
namespace {

Change in_probe(const Equirect& image, float strength = 1) {
  return [=](Scene& s) {
    s.probe = std::make_shared<const LightProbe>(make_probe(image, {}));
    s.lighting = {};
    s.lighting.ambient = glm::vec3(0);
    s.lighting.probe.id = s.probe->id;
    s.lighting.probe.strength = strength;
  };
}

class Probe : public ::testing::Test {
 protected:
  Probe() : egl_(gl::EglContext::create("auto")) { EXPECT_TRUE(egl_); }

  /// Returns the linear colours of fully covered texels.
  std::vector<glm::vec4> draw(const std::vector<Change>& changes) {
    egl_->make_current();
    const auto scene = prepared(changes);
    const GpuScene gpu(scene);
    TileShooter shooter = TileShooter::create(gpu, 2, {0, true, false}, true).take();
    const ObjectDescription& o = scene->objects[0];
    TileJob job;
    job.key.cell = *view_cell_from_direction({0.3, 0.8, 0.5}, 8);
    job.key.distance = *distance_bucket_from_radii(4, 2);
    job.key.size_class = 4;
    job.key.channels = kLitTile;
    job.lighting = object_lighting(scene->scene.lighting, scene->instance(0).world_from_object,
                                   o.center, o.radius);
    const TileShot shot = *shooter.shoot(job);
    std::vector<glm::vec4> out(shot.color.size() / sizeof(glm::vec4));
    std::memcpy(out.data(), shot.color.data(), shot.color.size());
    out.erase(std::remove_if(out.begin(), out.end(), [](const glm::vec4& c) { return c.a < 1; }),
              out.end());
    EXPECT_GT(out.size(), 500u);
    return out;
  }

  Result<gl::EglContext> egl_;
};

// Furnace test: if 0.8 comes from everywhere, a surface that reflects all light looks like 0.8,
// however rough it is and of whatever kind. No light is lost or added.
TEST_F(Probe, AFurnaceHidesWhatReflectsAll) {
  const Equirect gray{2, 1, {glm::vec3(0.8f), glm::vec3(0.8f)}};
  for (const float metallic : {0.0f, 1.0f}) {
    for (const float roughness : {0.0f, 0.3f, 0.7f, 1.0f}) {
      for (const float anisotropy : {0.0f, 0.5f, 1.0f}) {
        const auto white = [=](Scene& s) {
          s.materials[0].base_color = glm::vec4(1);
          s.materials[0].metallic = metallic;
          s.materials[0].roughness = roughness;
          s.materials[0].lobes.anisotropy = anisotropy;
        };
        for (const glm::vec4& c : draw({in_probe(gray), white})) {
          ASSERT_NEAR(c.g, 0.8f, 0.02f) << metallic << " " << roughness << " " << anisotropy;
        }
      }
    }
  }
}

// Turning the object together with the probe changes nothing: an object sees the probe on its own
// axes.
TEST_F(Probe, TurnsWithTheObject) {
  const Equirect sky = *builtin_environment("sky");
  const glm::quat turn = glm::angleAxis(2.1f, glm::normalize(glm::vec3(1, 2, -3)));
  const auto together = [&](Scene& s) {
    s.instances[0].world_from_object.rotation = turn;
    s.lighting.probe.rotation = turn;
  };
  const auto alone = [&](Scene& s) { s.instances[0].world_from_object.rotation = turn; };
  const auto still = draw({in_probe(sky)});
  EXPECT_EQ(draw({in_probe(sky), together}), still);
  EXPECT_NE(draw({in_probe(sky), alone}), still);
}

TEST_F(Probe, ItsStrengthScalesItsLight) {
  const Equirect studio = *builtin_environment("studio");
  const auto half = draw({in_probe(studio, 0.5f)}), whole = draw({in_probe(studio, 1)});
  ASSERT_EQ(half.size(), whole.size());
  for (std::size_t i = 0; i < half.size(); ++i) {
    ASSERT_NEAR(whole[i].r, 2 * half[i].r, 1e-3f);
    ASSERT_GT(half[i].r, 0.01f);
  }
}

// A probe that does not shine changes no bit, and a scene in a probe keeps all that is proven.
TEST_F(Probe, LeavingOutHolds) {
  const Equirect sky = *builtin_environment("sky");
  EXPECT_EQ(draw({in_probe(sky, 0), [](Scene& s) { s.lighting.ambient = glm::vec3(0.4f); }}),
            draw({[](Scene& s) {
              s.lighting = {};
              s.lighting.ambient = glm::vec3(0.4f);
            }}));
  std::vector<Change> all = {in_probe(sky, 0.6f)};
  for (const NamedChange& one : neutral_changes()) {
    if (one.rule != NeedRule::kLights && one.rule != NeedRule::kLighting) all.push_back(one.change);
  }
  ProofOptions options;
  options.cells = 3;
  const Proof proof = prove_needs(prepared(all), options).take();
  EXPECT_EQ(proof.total.differing_components, 0u);
  for (const ProofRow& row : proof.rows) EXPECT_EQ(row.differing_components, 0u);
}

}  // namespace
}  // namespace mirage::test

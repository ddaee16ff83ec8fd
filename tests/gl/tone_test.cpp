// Tone curves: what the shader shows of bright colours, beside the curve's own formula.

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "server/render/gpu_scene.h"
#include "shaders/gl/egl_context.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/render_target.h"

namespace mirage::test {
namespace {

/// Khronos PBR Neutral, as its page gives it.
glm::vec3 neutral(glm::vec3 c) {
  const float least = std::min({c.r, c.g, c.b});
  c -= least < 0.08f ? least - 6.25f * least * least : 0.04f;
  const float peak = std::max({c.r, c.g, c.b}), start = 0.76f;
  if (peak < start) return c;
  const float room = 1 - start, lower = 1 - room * room / (peak + room - start);
  const float share = 1 - 1 / (0.15f * (peak - lower) + 1);
  return glm::mix(c * (lower / peak), glm::vec3(lower), share);
}

class Tone : public ::testing::Test {
 protected:
  Tone() : egl_(gl::EglContext::create("auto")) {
    EXPECT_TRUE(egl_);
    target_ = gl::RenderTarget(4, 4, {GL_RGBA32F}, GL_DEPTH_COMPONENT32F);
  }

  /// Returns the colour of a white surface under this light from all sides.
  glm::vec3 shown(const glm::vec3& light, ToneCurve tone, bool unlit = false) {
    egl_->make_current();
    Mesh mesh;
    for (const glm::vec2 at : {glm::vec2(-9, -9), {9, -9}, {0, 9}}) {
      Vertex v;
      v.position = glm::vec3(at, -1);
      mesh.vertices.push_back(v);
    }
    mesh.indices = {0, 1, 2};
    mesh.primitives = {{PrimitiveKind::kTriangles, 0, 3, 0}};
    Material material;
    material.double_sided = true;
    material.unlit = unlit;
    if (unlit) material.base_color = glm::vec4(light, 1);
    material.metallic = 0;
    Environment environment;
    environment.tone = tone;
    gl::MeshPass pass(gl::MeshOutput::kColor);
    pass.set_surroundings(environment);
    target_.bind();
    glViewport(0, 0, 4, 4);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    ObjectLighting lighting;
    lighting.ambient = light;
    pass.begin(glm::perspective(glm::radians(60.0f), 1.0f, 0.1f, 10.0f),
               gl::light_block(lighting, {}));
    const gl::MeshInstance here;
    pass.draw(gl::GpuMesh(mesh), {material}, gl::GpuImages(), &here, 1, false);
    pass.end();
    glm::vec4 out(-1);
    glReadPixels(1, 1, 1, 1, GL_RGBA, GL_FLOAT, &out);
    EXPECT_EQ(out.a, 1);
    return glm::vec3(out);
  }

  Result<gl::EglContext> egl_;
  gl::RenderTarget target_;
};

TEST_F(Tone, NeutralIsTheFormula) {
  for (const glm::vec3 light : {glm::vec3(0),
                                {0.02f, 0.05f, 0.5f},
                                {0.18f, 0.18f, 0.18f},
                                {0.75f, 0.7f, 0.6f},
                                {1, 1, 1},
                                {4, 2, 0.5f},
                                {1000, 10, 1}}) {
    const glm::vec3 got = shown(light, ToneCurve::kNeutral), wanted = neutral(light);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 2e-5) << light.r << ", " << c;
  }
  const glm::vec3 bright = shown(glm::vec3(1.5f), ToneCurve::kNeutral);
  EXPECT_LT(bright.r, 0.97f) << "a bright statue keeps its shape";
  EXPECT_GT(bright.r, shown(glm::vec3(1.2f), ToneCurve::kNeutral).r);
}

TEST_F(Tone, HugeLightIsWhiteAndNothingElse) {
  for (const float huge : {1e6f, 1e30f, std::numeric_limits<float>::infinity()}) {
    const glm::vec3 got = shown(glm::vec3(huge), ToneCurve::kNeutral);
    EXPECT_NEAR(got.r, 1, 1e-3) << huge;
    EXPECT_EQ(got.r, got.g);
  }
}

TEST_F(Tone, ClipAndUnlitColoursStay) {
  EXPECT_EQ(shown(glm::vec3(0.5f, 0.9f, 2), ToneCurve::kClip), glm::vec3(0.5f, 0.9f, 1));
  EXPECT_EQ(shown(glm::vec3(0.5f, 0.9f, 1), ToneCurve::kNeutral, true), glm::vec3(0.5f, 0.9f, 1));
}

}  // namespace
}  // namespace mirage::test

// Meshes of more elements than a software renderer draws at once: each is drawn, and none twice.

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "shaders/gl/egl_context.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/render_target.h"

namespace mirage::test {
namespace {

constexpr int kPacedWidth = 640,
              kPacedHeight = 640;  // points and triangles of three parts and a bit
constexpr float kAlpha = 0.25f;

/// Returns one vertex at the lower left corner of each cell of a grid over the picture, and the
/// last ones on the far sides.
std::vector<Vertex> grid() {
  std::vector<Vertex> out;
  for (int y = 0; y <= kPacedHeight; ++y) {
    for (int x = 0; x <= kPacedWidth; ++x) out.emplace_back().position = {x, y, 0};
  }
  return out;
}

std::vector<std::uint32_t> cells(PrimitiveKind kind) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t y = 0; y < kPacedHeight; ++y) {
    for (std::uint32_t x = 0; x < kPacedWidth; ++x) {
      const std::uint32_t at = y * (kPacedWidth + 1) + x, above = at + kPacedWidth + 1;
      if (kind == PrimitiveKind::kPoints) {
        out.push_back(at);
      } else {
        out.insert(out.end(), {at, at + 1, above, at + 1, above + 1, above});
      }
    }
  }
  return out;
}

/// Expects that each pixel of the picture has been covered once.
void expect_all_drawn_once(PrimitiveKind kind, float middle) {
  auto egl = gl::EglContext::create("auto");
  ASSERT_TRUE(egl);
  egl->make_current();
  {
    Mesh mesh;
    mesh.vertices = grid();
    mesh.indices = cells(kind);
    mesh.primitives = {{kind, 0, static_cast<std::uint32_t>(mesh.indices.size()), 0}};
    Material material;
    material.unlit = material.double_sided = true;
    material.alpha_mode = AlphaMode::kBlend;
    material.base_color.a = kAlpha;
    const gl::RenderTarget target(kPacedWidth, kPacedHeight, {GL_RGBA32F}, GL_DEPTH_COMPONENT32F);
    target.bind();
    glViewport(0, 0, kPacedWidth, kPacedHeight);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl::MeshPass pass(gl::MeshOutput::kColor);
    pass.begin(glm::ortho(-middle, kPacedWidth - middle, -middle, kPacedHeight - middle), {});
    const gl::MeshInstance instance;
    pass.draw(gl::GpuMesh(mesh), {material}, {}, &instance, 1, true);
    pass.end();
    std::vector<glm::vec4> pixels(std::size_t{kPacedWidth} * kPacedHeight);
    glReadPixels(0, 0, kPacedWidth, kPacedHeight, GL_RGBA, GL_FLOAT, pixels.data());
    std::size_t wrong = 0;
    for (const glm::vec4& pixel : pixels) wrong += pixel.a != kAlpha;
    EXPECT_EQ(wrong, 0u);
  }
}

TEST(PacedDraw, DrawsEachPointOnce) { expect_all_drawn_once(PrimitiveKind::kPoints, 0.5f); }
TEST(PacedDraw, DrawsEachTriangleOnce) { expect_all_drawn_once(PrimitiveKind::kTriangles, 0); }

}  // namespace
}  // namespace mirage::test

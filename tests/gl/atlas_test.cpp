// Layered textures: layers are made when needed, and former content stays, byte for byte.
#include <gtest/gtest.h>

#include "client/draw/impostor_atlas.h"
#include "client/draw/layered_texture.h"
#include "shaders/gl/egl_context.h"

namespace mirage::test {
namespace {

constexpr int kAtlasEdge = 64, kLayers = 6;

/// Returns another byte for every place of every layer.
std::vector<std::uint8_t> pattern(int layer, int channels) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(kAtlasEdge * kAtlasEdge * channels));
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<std::uint8_t>(i * 7 + i / 251 + static_cast<std::size_t>(layer) * 31);
  }
  return out;
}

std::vector<std::uint8_t> read(const LayeredTexture& texture, int layer, int channels) {
  const gl::Framebuffer framebuffer = gl::Framebuffer::create();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer.id());
  glFramebufferTextureLayer(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture.id(), 0, layer);
  std::vector<std::uint8_t> out(static_cast<std::size_t>(kAtlasEdge * kAtlasEdge * channels));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, kAtlasEdge, kAtlasEdge, channels == 1 ? GL_RED : GL_RGBA, GL_UNSIGNED_BYTE,
               out.data());
  return out;
}

TEST(LayeredTexture, GrowsByNeedAndKeepsWhatIsThere) {
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  ASSERT_TRUE(egl);
  for (const GLenum format : {GL_SRGB8_ALPHA8, GL_RGBA8, GL_R8}) {
    LayeredTexture texture({format, GL_NEAREST}, kAtlasEdge, kLayers, LayerSupply::kByNeed);
    EXPECT_EQ(texture.gpu_bytes(), 0u);
    EXPECT_EQ(texture.id(), 0u);
    const int channels = format == GL_R8 ? 1 : 4;
    const auto layer_bytes = static_cast<std::size_t>(kAtlasEdge * kAtlasEdge * channels);
    const auto put = [&](int layer) {
      const std::vector<std::uint8_t> texels = pattern(layer, channels);
      return texture.upload(layer, 0, 0, kAtlasEdge, kAtlasEdge, texels.data());
    };
    int there[] = {1, 2, 4, 4, kLayers};  // doubled, up to the budget
    for (int layer = 0; layer < 5; ++layer) {
      ASSERT_TRUE(put(layer));
      EXPECT_EQ(texture.layers(), there[layer]);
      EXPECT_EQ(texture.gpu_bytes(), layer_bytes * static_cast<std::size_t>(there[layer]));
    }
    for (int layer = 0; layer < 5; ++layer) {
      EXPECT_EQ(read(texture, layer, channels), pattern(layer, channels)) << format << layer;
    }
  }
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST(LayeredTexture, HasAllItsLayersAtOnceOnACard) {
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  ASSERT_TRUE(egl);
  LayeredTexture texture({GL_R8, GL_NEAREST}, kAtlasEdge, kLayers, LayerSupply::kAtOnce);
  EXPECT_EQ(texture.gpu_bytes(), 0u);
  for (const int layer : {0, kLayers - 1}) {
    ASSERT_TRUE(texture.upload(layer, 0, 0, kAtlasEdge, kAtlasEdge, pattern(layer, 1).data()));
    EXPECT_EQ(texture.layers(), kLayers);
  }
  for (const int layer : {0, kLayers - 1}) EXPECT_EQ(read(texture, layer, 1), pattern(layer, 1));
}

TEST(ImpostorAtlas, TakesNoMemoryBeforeTheFirstTile) {
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  ASSERT_TRUE(egl);
  const Result<ImpostorAtlas> atlas = ImpostorAtlas::create(1024, 24);
  ASSERT_TRUE(atlas);
  EXPECT_EQ(atlas->gpu_bytes(), 0u);
  const Result<ImpostorAtlas> large = ImpostorAtlas::create(1024, 1 << 20);
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().id, ErrorId::kGraphicsGl);
}

}  // namespace
}  // namespace mirage::test

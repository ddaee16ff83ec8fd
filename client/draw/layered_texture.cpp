#include "client/draw/layered_texture.h"

#include <algorithm>

#include "shaders/gl/dialect.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

GLenum layout_of(const LayeredTexture::Format& format) {
  return format.channels() == 1 ? GL_RED : GL_RGBA;
}

// Copies the first `layers` of a texture to another one of the same format.
void copy_layers(GLuint from, GLuint to, int edge, int layers) {
  const gl::Framebuffer framebuffer = gl::Framebuffer::create();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer.id());
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, to);
  for (int i = 0; i < layers; ++i) {
    glFramebufferTextureLayer(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, from, 0, i);
    glCopyTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, i, 0, 0, edge, edge);
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
}

}  // namespace

LayerSupply usual_supply() {
  return gl::is_embedded() || gl::is_software() ? LayerSupply::kByNeed : LayerSupply::kAtOnce;
}

Result<void> LayeredTexture::upload(int layer, int x, int y, int w, int h,
                                    const std::uint8_t* texels) {
  if (layer >= layers_) {
    const int wanted =
        std::max(layer + 1, supply_ == LayerSupply::kAtOnce ? max_layers_ : 2 * layers_);
    if (Result<void> grown = grow(std::min(max_layers_, wanted)); !grown) return grown;
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, x, y, layer, w, h, 1, layout_of(format_),
                  GL_UNSIGNED_BYTE, texels);
  return {};
}

Result<void> LayeredTexture::make(int layers) {
  while (glGetError() != GL_NO_ERROR) {
  }
  texture_ = gl::Texture();
  texture_ = gl::Texture::create();
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, static_cast<GLint>(format_.stored), edge_, edge_, layers, 0,
               layout_of(format_), GL_UNSIGNED_BYTE, nullptr);
  if (glGetError() != GL_NO_ERROR) {
    texture_ = gl::Texture();
    layers_ = 0;
    return make_error(ErrorId::kGraphicsGl, "the atlas does not fit the graphics memory",
                      "--atlas-mb takes less");
  }
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
    glTexParameteri(GL_TEXTURE_2D_ARRAY, filter, format_.filter);
  }
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
    glTexParameteri(GL_TEXTURE_2D_ARRAY, wrap, GL_CLAMP_TO_EDGE);
  }
  layers_ = layers;
  return {};
}

Result<void> LayeredTexture::grow(int layers) {
  const int kept = layers_;
  const gl::Texture before = std::move(texture_);
  Result<void> made = make(layers);
  if (made) copy_layers(before.id(), texture_.id(), edge_, kept);
  return made;
}

}  // namespace mirage

#include "client/draw/layered_texture.h"

#include <algorithm>

#include "shaders/gl/dialect.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

GLenum layout_of(const LayeredTexture::Format& format) {
  return format.channels() == 1 ? GL_RED : GL_RGBA;
}

// Two framebuffers, to copy from one texture to another. Copies leave texels as they are.
class Blit {
 public:
  Blit(gl::Framebuffer& from, gl::Framebuffer& to) {
    if (!from) from = gl::Framebuffer::create();
    if (!to) to = gl::Framebuffer::create();
    gl::encode_srgb(false);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to.id());
  }
  Blit(const Blit&) = delete;
  Blit& operator=(const Blit&) = delete;
  ~Blit() {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    gl::encode_srgb(true);
  }
};

constexpr int kSmallStep = 256;  // texels; edges of the small texture are multiples of it

}  // namespace

// In a browser the page's process does not draw, and how drivers keep textures is hidden from it.
TexelWay usual_texel_way() {
  return gl::is_embedded() || gl::is_software() ? TexelWay::kStraight : TexelWay::kBlitted;
}

Result<void> LayeredTexture::upload(int layer, int x, int y, int w, int h,
                                    const std::uint8_t* texels) {
  if (layer >= layers_) {
    const int wanted = std::min(max_layers_, std::max(layer + 1, 2 * layers_));
    if (Result<void> grown = grow(wanted); !grown) return grown;
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (way_ == TexelWay::kStraight) {
    glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, x, y, layer, w, h, 1, layout_of(format_),
                    GL_UNSIGNED_BYTE, texels);
    return {};
  }
  bind_small(std::max(w, h));
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, w, h, layout_of(format_), GL_UNSIGNED_BYTE, texels);
  const Blit blit(from_, to_);
  glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, small_.id(), 0);
  glFramebufferTextureLayer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture_.id(), 0, layer);
  glBlitFramebuffer(0, 0, w, h, x, y, x + w, y + h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  return {};
}

void LayeredTexture::bind_small(int edge) {
  if (!small_) small_ = gl::Texture::create();
  glBindTexture(GL_TEXTURE_2D, small_.id());
  if (edge <= small_edge_) return;
  small_edge_ = (edge + kSmallStep - 1) / kSmallStep * kSmallStep;
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format_.stored), small_edge_, small_edge_, 0,
               layout_of(format_), GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
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
  if (made) copy_layers(before, kept);
  return made;
}

void LayeredTexture::copy_layers(const gl::Texture& from, int layers) {
  const Blit blit(from_, to_);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  for (int i = 0; i < layers; ++i) {
    glFramebufferTextureLayer(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, from.id(), 0, i);
    if (way_ == TexelWay::kStraight) {
      glCopyTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, i, 0, 0, edge_, edge_);
      continue;
    }
    glFramebufferTextureLayer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture_.id(), 0, i);
    glBlitFramebuffer(0, 0, edge_, edge_, 0, 0, edge_, edge_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
}

}  // namespace mirage

#include "client/draw/frame_target.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

gl::Renderbuffer storage(GLenum format, GLenum attachment, int w, int h, int samples) {
  gl::Renderbuffer buffer = gl::Renderbuffer::create();
  glBindRenderbuffer(GL_RENDERBUFFER, buffer.id());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, w, h);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.id());
  return buffer;
}

bool complete() { return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE; }

}  // namespace

Result<FrameTarget> FrameTarget::create(int width, int height, int samples, bool blends,
                                        double scale) {
  FrameTarget t;
  GLint most = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  t.width_ = width;
  t.height_ = height;
  // Some devices give four samples if asked for one.
  t.samples_ = samples > 1 ? std::min(samples, static_cast<int>(most)) : 0;
  const auto scaled = [&](int edge) {
    return t.samples_ > 0 ? edge : std::max(1, static_cast<int>(std::lround(edge * scale)));
  };
  t.drawn_width_ = scaled(width);
  t.drawn_height_ = scaled(height);
  t.blends_ = blends;
  const GLenum format = gl::color_format(blends);
  if (format != GL_SRGB8_ALPHA8 && t.make(format)) return t;
  if (Result<void> made = t.make(GL_SRGB8_ALPHA8); !made) return made.error();
  return t;
}

Result<void> FrameTarget::make(GLenum drawn_format) {
  bool ok = true;
  draw_ = gl::Framebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, draw_.id());
  format_ = drawn_format;
  color_ = storage(drawn_format, GL_COLOR_ATTACHMENT0, drawn_width_, drawn_height_, samples_);
  depth_ =
      storage(GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, drawn_width_, drawn_height_, samples_);
  ok = ok && complete();
  averaged_ = gl::Framebuffer();
  averaged_color_ = gl::Renderbuffer();
  if (drawn_format != GL_SRGB8_ALPHA8 && samples_ > 0) {
    averaged_ = gl::Framebuffer::create();
    glBindFramebuffer(GL_FRAMEBUFFER, averaged_.id());
    averaged_color_ = storage(drawn_format, GL_COLOR_ATTACHMENT0, width_, height_, 0);
    ok = ok && complete();
  }
  resolved_ = gl::Framebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_.id());
  resolved_color_ = gl::Texture::create();
  glBindTexture(GL_TEXTURE_2D, resolved_color_.id());
  glTexStorage2D(GL_TEXTURE_2D, 1, GL_SRGB8_ALPHA8, width_, height_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, resolved_color_.id(),
                         0);
  ok = ok && complete();
  if (enlarges()) {
    small_ = gl::Framebuffer::create();
    glBindFramebuffer(GL_FRAMEBUFFER, small_.id());
    small_color_ = gl::Texture::create();
    glBindTexture(GL_TEXTURE_2D, small_color_.id());
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_SRGB8_ALPHA8, drawn_width_, drawn_height_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, small_color_.id(),
                           0);
    ok = ok && complete();
  }
  if (ok) return {};
  return make_error(ErrorId::kGraphicsGl, "no framebuffer of " + std::to_string(width_) + "x" +
                                              std::to_string(height_) + " can be made");
}

void FrameTarget::copy(const gl::Framebuffer& from, const gl::Framebuffer& to) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, from.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to.id());
  glBlitFramebuffer(0, 0, drawn_width_, drawn_height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT,
                    enlarges() ? GL_LINEAR : GL_NEAREST);
}

Camera FrameTarget::drawn_camera(const Camera& camera) const {
  return camera.at_size(static_cast<std::uint32_t>(drawn_width_),
                        static_cast<std::uint32_t>(drawn_height_));
}

void FrameTarget::copy_to(const gl::Framebuffer& to) const { copy(draw_, to); }

void FrameTarget::resolve() const {
  // A multisampled source must not change its format while it is resolved.
  if (averaged_) copy(draw_, averaged_);
  copy(averaged_ ? averaged_ : draw_, resolved_);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_.id());
}

void FrameTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, draw_.id());
  glViewport(0, 0, drawn_width_, drawn_height_);
}

std::vector<std::uint8_t> FrameTarget::read() const {
  resolve();
  const std::size_t row = static_cast<std::size_t>(width_) * 4;
  std::vector<std::uint8_t> up(row * static_cast<std::size_t>(height_)), down(up.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, up.data());
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y) {
    std::memcpy(&down[y * row], &up[(static_cast<std::size_t>(height_) - 1 - y) * row], row);
  }
  return down;
}

GLuint FrameTarget::resolved_texture() const {
  resolve_drawn();
  return enlarges() ? small_color_.id() : resolved_color_.id();
}

GLuint FrameTarget::depth_texture() const {
  if (!read_depth_) {
    gl::Texture texels = gl::Texture::create();
    glBindTexture(GL_TEXTURE_2D, texels.id());
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT32F, drawn_width_, drawn_height_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl::Framebuffer framebuffer = gl::Framebuffer::create();
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.id());
    glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texels.id(), 0);
    if (glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return 0;
    depth_texels_ = std::move(texels);
    read_depth_ = std::move(framebuffer);
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, draw_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, read_depth_.id());
  glBlitFramebuffer(0, 0, drawn_width_, drawn_height_, 0, 0, drawn_width_, drawn_height_,
                    GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  return depth_texels_.id();
}

void FrameTarget::resolve_drawn() const {
  if (!enlarges()) return resolve();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, draw_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, small_.id());
  glBlitFramebuffer(0, 0, drawn_width_, drawn_height_, 0, 0, drawn_width_, drawn_height_,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, small_.id());
}

std::size_t FrameTarget::gpu_bytes() const {
  const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  const std::size_t drawn =
      static_cast<std::size_t>(drawn_width_) * static_cast<std::size_t>(drawn_height_);
  const std::size_t averaged = averaged_ ? 8 : 0;
  const std::size_t sample = format_ == GL_SRGB8_ALPHA8 ? 8 : 12;  // bytes of colour and depth
  return drawn * sample * static_cast<std::size_t>(std::max(samples_, 1)) +
         pixels * (averaged + 4) + (enlarges() ? 4 * drawn : 0) + (read_depth_ ? 4 * drawn : 0);
}

}  // namespace mirage

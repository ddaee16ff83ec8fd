#include "client/core/frame_target.h"

#include <algorithm>
#include <cstring>

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

Result<FrameTarget> FrameTarget::create(int width, int height, int samples) {
  FrameTarget t;
  GLint most = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  t.width_ = width;
  t.height_ = height;
  t.samples_ = std::min(samples, static_cast<int>(most));
  t.draw_ = gl::Framebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, t.draw_.id());
  t.color_ = storage(GL_SRGB8_ALPHA8, GL_COLOR_ATTACHMENT0, width, height, t.samples_);
  t.depth_ = storage(GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, width, height, t.samples_);
  const bool draw_ok = complete();
  t.resolved_ = gl::Framebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, t.resolved_.id());
  t.resolved_color_ = storage(GL_SRGB8_ALPHA8, GL_COLOR_ATTACHMENT0, width, height, 0);
  if (!draw_ok || !complete()) {
    return make_error(ErrorId::kGraphicsGl, "no framebuffer of " + std::to_string(width) + "x" +
                                                std::to_string(height) + " can be made");
  }
  return t;
}

void FrameTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, draw_.id());
  glViewport(0, 0, width_, height_);
}

std::vector<std::uint8_t> FrameTarget::read() const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, draw_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.id());
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_.id());
  const std::size_t row = static_cast<std::size_t>(width_) * 4;
  std::vector<std::uint8_t> up(row * static_cast<std::size_t>(height_)), down(up.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, up.data());
  for (std::size_t y = 0; y < static_cast<std::size_t>(height_); ++y) {
    std::memcpy(&down[y * row], &up[(static_cast<std::size_t>(height_) - 1 - y) * row], row);
  }
  return down;
}

void FrameTarget::show() const {
  // Twice, because a multisampled source must not change format while it is resolved.
  glBindFramebuffer(GL_READ_FRAMEBUFFER, draw_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.id());
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glDisable(GL_FRAMEBUFFER_SRGB);  // copy the encoded bytes as they are
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glEnable(GL_FRAMEBUFFER_SRGB);
}

std::size_t FrameTarget::gpu_bytes() const {
  const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  return pixels * 8 * static_cast<std::size_t>(std::max(samples_, 1)) + pixels * 4;
}

}  // namespace mirage

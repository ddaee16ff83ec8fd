#include "shaders/gl/render_target.h"

namespace mirage::gl {
namespace {

Texture make_texture(int width, int height, GLenum internal_format) {
  Texture texture = Texture::create();
  glBindTexture(GL_TEXTURE_2D, texture.id());
  GLenum format = GL_RGBA, type = GL_UNSIGNED_BYTE;
  if (internal_format == GL_DEPTH_COMPONENT32F) {
    format = GL_DEPTH_COMPONENT;
    type = GL_FLOAT;
  } else if (internal_format == GL_R32UI) {
    format = GL_RED_INTEGER;
    type = GL_UNSIGNED_INT;
  } else if (internal_format == GL_R32F) {
    format = GL_RED;
    type = GL_FLOAT;
  } else if (internal_format == GL_RGBA16F) {
    type = GL_FLOAT;
  } else if (internal_format == GL_R8) {
    format = GL_RED;
  }
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, format,
               type, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  }
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

std::size_t texel_bytes(GLenum internal_format) {
  switch (internal_format) {
    case GL_R8:
      return 1;
    case GL_RGBA16F:
      return 8;
    case GL_RGBA32F:
      return 16;
    default:
      return 4;
  }
}

}  // namespace

std::size_t target_bytes(int width, int height, const std::vector<GLenum>& colors, GLenum depth) {
  std::size_t texel = depth != 0 ? texel_bytes(depth) : 0;
  for (const GLenum color : colors) texel += texel_bytes(color);
  return texel * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

RenderTarget::RenderTarget(int width, int height, const std::vector<GLenum>& colors, GLenum depth)
    : framebuffer_(Framebuffer::create()),
      width_(width),
      height_(height),
      bytes_(target_bytes(width, height, colors, depth)) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  std::vector<GLenum> attachments;
  for (const GLenum format : colors) {
    const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(attachments.size());
    colors_.push_back(make_texture(width, height, format));
    glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, colors_.back().id(), 0);
    attachments.push_back(attachment);
  }
  glDrawBuffers(static_cast<GLsizei>(attachments.size()), attachments.data());
  if (depth != 0) {
    depth_ = make_texture(width, height, depth);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.id(), 0);
  }
  ok_ = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  // The error means that there is no room for it; nothing else can fail here.
  if (glGetError() != GL_NO_ERROR) ok_ = false;
}

void RenderTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, width_, height_);
}

}  // namespace mirage::gl

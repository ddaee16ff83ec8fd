#pragma once
// Colour (+ depth, + more) textures behind a framebuffer.

#include <vector>

#include "shaders/gl/gl_object.h"

namespace mirage::gl {

/// Returns the graphics memory of a target with these attachments, bytes; `depth` 0: none.
std::size_t target_bytes(int width, int height, const std::vector<GLenum>& colors, GLenum depth);

class RenderTarget {
 public:
  RenderTarget() = default;
  /// Makes colour attachments of the given internal formats and, if not 0, a depth texture.
  /// Textures sample NEAREST. Check ok() afterwards.
  RenderTarget(int width, int height, const std::vector<GLenum>& colors, GLenum depth);

  void bind() const;
  bool ok() const { return ok_; }
  int width() const { return width_; }
  int height() const { return height_; }
  GLuint framebuffer() const { return framebuffer_.id(); }
  GLuint color(std::size_t i) const { return colors_[i].id(); }
  GLuint depth() const { return depth_.id(); }
  std::size_t gpu_bytes() const { return bytes_; }

 private:
  Framebuffer framebuffer_;
  std::vector<Texture> colors_;
  Texture depth_;
  int width_ = 0;
  int height_ = 0;
  std::size_t bytes_ = 0;
  bool ok_ = false;
};

}  // namespace mirage::gl

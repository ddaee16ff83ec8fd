#pragma once
// The client's framebuffer: multisampled sRGB colour and depth, resolved for reading or display.

#include <cstdint>
#include <vector>

#include "protocol/result.h"
#include "shaders/gl/gl_object.h"

namespace mirage {

class FrameTarget {
 public:
  /// `samples` 0: none. Error kGraphicsGl.
  static Result<FrameTarget> create(int width, int height, int samples);

  void bind() const;
  /// Resolves and reads RGBA8, top row first; alpha is the coverage by objects.
  std::vector<std::uint8_t> read() const;
  /// Resolves to the window's framebuffer (0).
  void show() const;
  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t gpu_bytes() const;

 private:
  gl::Framebuffer draw_;
  gl::Framebuffer resolved_;
  gl::Renderbuffer color_, depth_, resolved_color_;
  int width_ = 0, height_ = 0, samples_ = 0;
};

}  // namespace mirage

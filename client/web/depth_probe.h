#pragma once
// Depth probe: reads texels of a depth texture.
// Input:  a depth texture, a part of it.
// Output: its window depths.
// Thread: the GL thread.
// Full:   never. Reading waits for the graphics card, so it is for a person's hand, not for frames.

#include <vector>

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

class DepthProbe {
 public:
  /// Error kGraphicsShader.
  static Result<DepthProbe> create();

  /// Returns the window depth of a texel. It leaves its framebuffer bound.
  float read(GLuint texture, int x, int y) { return read(texture, x, y, 1, 1)[0]; }
  /// Returns those of `width` x `height` texels from (x, y) on, rows from the bottom.
  std::vector<float> read(GLuint texture, int x, int y, int width, int height);

 private:
  gl::Program program_;
  gl::VertexArray vao_;
  gl::Framebuffer framebuffer_;
  gl::Renderbuffer bytes_;
  int width_ = 0, height_ = 0;  // of the buffer
};

}  // namespace mirage

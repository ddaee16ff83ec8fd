#pragma once
// Depth probe: reads single texels of a depth texture.
// Input:  a depth texture, a place in it.
// Output: its window depth.
// Thread: the GL thread.
// Full:   never. Reading waits for the graphics card, so it is for a person's hand, not for frames.

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

class DepthProbe {
 public:
  /// Error kGraphicsShader.
  static Result<DepthProbe> create();

  /// Returns the window depth of a texel. It leaves its framebuffer bound.
  float read(GLuint texture, int x, int y);

 private:
  gl::Program program_;
  gl::VertexArray vao_;
  gl::Framebuffer framebuffer_;
  gl::Renderbuffer texel_;
};

}  // namespace mirage

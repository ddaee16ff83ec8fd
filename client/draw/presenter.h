#pragma once
// Shows a picture in the window's framebuffer (0), the bytes as they are. Thread: the GL one.

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

class FrameTarget;

class Presenter {
 public:
  /// Error kGraphicsShader.
  static Result<Presenter> create();
  void show(const FrameTarget& picture);

 private:
  gl::Program encode_;  // OpenGL ES decodes what it copies: there a program encodes again
  gl::VertexArray vao_;
};

}  // namespace mirage

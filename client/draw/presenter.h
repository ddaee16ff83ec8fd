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
  /// Enlarged, where it is drawn smaller.
  void show(const FrameTarget& picture);
  /// The framebuffer is as large as what is drawn: a browser enlarges it as it puts the page
  /// together, which it does in any case.
  void show_as_drawn(const FrameTarget& picture);

 private:
  void encode(GLuint texture, int width, int height);
  void enlarge(const FrameTarget& picture);

  gl::Program encode_;  // OpenGL ES decodes what it copies: there a program encodes again
  gl::VertexArray vao_;
  gl::Framebuffer small_;  ///< sRGB bytes of a picture that is to be enlarged
  gl::Texture small_color_;
  int small_width_ = 0, small_height_ = 0;
};

}  // namespace mirage

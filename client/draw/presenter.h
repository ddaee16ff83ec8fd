#pragma once
// Presenter: shows a picture in the window's framebuffer (0), with unchanged bytes.
// Input:  a drawn picture.
// Output: its bytes in the window's framebuffer.
// Thread: the GL thread.
// Full:   never; it keeps no queue.

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

class FrameTarget;

class Presenter {
 public:
  /// Creates the presenter. Error kGraphicsShader.
  static Result<Presenter> create();
  /// Shows the picture, enlarged if it was drawn smaller.
  void show(const FrameTarget& picture);
  /// Shows the picture at its drawn size, which the framebuffer must have. A browser enlarges it
  /// when it puts the page together, which it does in any case.
  void show_as_drawn(const FrameTarget& picture);

 private:
  void encode(GLuint texture, int width, int height);
  void enlarge(const FrameTarget& picture);

  gl::Program encode_;  // for OpenGL ES, which decodes what it copies; encodes it again
  gl::VertexArray vao_;
  gl::Framebuffer small_;  ///< sRGB bytes of a picture that is enlarged
  gl::Texture small_color_;
  int small_width_ = 0, small_height_ = 0;
};

}  // namespace mirage

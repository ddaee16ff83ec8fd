#pragma once
#include <string>

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

/// A few lines of text in the corner of the window.
class Overlay {
 public:
  static Result<Overlay> create();
  /// Draws into the bound framebuffer of the given size.
  void draw(const std::string& text, int width, int height);

 private:
  gl::Program program_;
  gl::VertexArray vao_;
  gl::Buffer vertices_;
};

}  // namespace mirage

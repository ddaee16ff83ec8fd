#include "client/draw/presenter.h"

#include "client/draw/frame_target.h"
#include "shaders/gl/dialect.h"

namespace mirage {

Result<Presenter> Presenter::create() {
  Presenter out;
  if (!gl::is_embedded()) return out;
  Result<gl::Program> program =
      gl::Program::create("common/fullscreen.vert", "common/encode.frag", {});
  if (!program) return program.error();
  out.encode_ = program.take();
  out.vao_ = gl::VertexArray::create();
  return out;
}

void Presenter::show(const FrameTarget& picture) {
  const int w = picture.width(), h = picture.height();
  if (!encode_) {
    // Only the drawn pixels are encoded. The encoded bytes are copied, or enlarged, as they are:
    // encoding all pixels of the window takes a software renderer 4 ms more at 1280x720.
    picture.resolve_drawn();
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    gl::encode_srgb(false);
    glBlitFramebuffer(0, 0, picture.drawn_width(), picture.drawn_height(), 0, 0, w, h,
                      GL_COLOR_BUFFER_BIT, picture.enlarges() ? GL_LINEAR : GL_NEAREST);
    gl::encode_srgb(true);
    return;
  }
  if (picture.enlarges()) {
    enlarge(picture);
  } else {
    show_as_drawn(picture);
  }
}

void Presenter::show_as_drawn(const FrameTarget& picture) {
  const GLuint texture = picture.resolved_texture();
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  encode(texture, picture.drawn_width(), picture.drawn_height());
}

void Presenter::encode(GLuint texture, int width, int height) {
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  encode_.use();
  encode_.set("u_color", 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture);
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glEnable(GL_DEPTH_TEST);
}

void Presenter::enlarge(const FrameTarget& picture) {
  const int w = picture.drawn_width(), h = picture.drawn_height();
  if (w != small_width_ || h != small_height_) {
    small_color_ = gl::Texture::create();
    glBindTexture(GL_TEXTURE_2D, small_color_.id());
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, w, h);
    small_ = gl::Framebuffer::create();
    glBindFramebuffer(GL_FRAMEBUFFER, small_.id());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, small_color_.id(),
                           0);
    small_width_ = w;
    small_height_ = h;
  }
  const GLuint texture = picture.resolved_texture();
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, small_.id());
  encode(texture, w, h);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, small_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, w, h, 0, 0, picture.width(), picture.height(), GL_COLOR_BUFFER_BIT,
                    GL_LINEAR);
}

}  // namespace mirage

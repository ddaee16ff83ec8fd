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
    picture.resolve();
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    gl::encode_srgb(false);  // copy the encoded bytes as they are
    glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl::encode_srgb(true);
    return;
  }
  const GLuint texture = picture.resolved_texture();
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glViewport(0, 0, w, h);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  encode_.use();
  encode_.set("u_color", 0);
  encode_.set("u_size", glm::vec2(w, h));
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture);
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace mirage

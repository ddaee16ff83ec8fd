#include "client/web/depth_probe.h"

namespace mirage {

Result<DepthProbe> DepthProbe::create() {
  DepthProbe out;
  Result<gl::Program> program =
      gl::Program::create("common/fullscreen.vert", "view/depth_texel.frag", {});
  if (!program) return program.error();
  out.program_ = program.take();
  out.vao_ = gl::VertexArray::create();
  out.framebuffer_ = gl::Framebuffer::create();
  out.bytes_ = gl::Renderbuffer::create();
  return out;
}

std::vector<float> DepthProbe::read(GLuint texture, int x, int y, int width, int height) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  if (width != width_ || height != height_) {
    glBindRenderbuffer(GL_RENDERBUFFER, bytes_.id());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, bytes_.id());
    width_ = width;
    height_ = height;
  }
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture);
  program_.use();
  program_.set("u_depth", 0);
  program_.set("u_texel", glm::ivec2(x, y));
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
  // WebAssembly has the lowest byte first, as the shader writes them.
  std::vector<float> out(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, out.data());
  return out;
}

}  // namespace mirage

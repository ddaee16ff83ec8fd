#include "client/web/depth_probe.h"

#include <array>
#include <cstring>

namespace mirage {

Result<DepthProbe> DepthProbe::create() {
  DepthProbe out;
  Result<gl::Program> program =
      gl::Program::create("common/fullscreen.vert", "view/depth_texel.frag", {});
  if (!program) return program.error();
  out.program_ = program.take();
  out.vao_ = gl::VertexArray::create();
  out.framebuffer_ = gl::Framebuffer::create();
  out.texel_ = gl::Renderbuffer::create();
  glBindRenderbuffer(GL_RENDERBUFFER, out.texel_.id());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
  glBindFramebuffer(GL_FRAMEBUFFER, out.framebuffer_.id());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, out.texel_.id());
  return out;
}

float DepthProbe::read(GLuint texture, int x, int y) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, 1, 1);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture);
  program_.use();
  program_.set("u_depth", 0);
  program_.set("u_texel", glm::ivec2(x, y));
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  std::array<std::uint8_t, 4> bytes{};
  glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
  float depth = 0;
  std::memcpy(&depth, bytes.data(), sizeof(depth));  // WebAssembly has the lowest byte first
  return depth;
}

}  // namespace mirage

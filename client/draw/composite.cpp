#include "client/draw/composite.h"

#include "client/draw/frame_target.h"
#include "protocol/impostor/camera.h"
#include "shaders/gl/dialect.h"

namespace mirage {

Result<Composite> Composite::create() {
  Composite out;
  Result<gl::Program> program =
      gl::Program::create("common/fullscreen.vert", "view/composite.frag", {});
  if (!program) return program.error();
  out.program_ = program.take();
  out.vao_ = gl::VertexArray::create();
  return out;
}

Result<void> Composite::draw(const FrameTarget& picture, const Camera& camera, double metre,
                             bool background, const HostTarget& target) {
  const GLuint color = picture.resolved_texture(), depth = picture.depth_texture();
  if (depth == 0) return make_error(ErrorId::kGraphicsGl, "no memory for a depth texture");
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, depth);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, color);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  gl::encode_srgb(target.color == HostColor::kEncodedByHardware);
  glViewport(target.x, target.y, picture.width(), picture.height());

  (target.depth ? glEnable : glDisable)(GL_DEPTH_TEST);
  glDepthFunc(target.host.reversed ? GL_GEQUAL : GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glDisable(GL_CULL_FACE);
  (background ? glDisable : glEnable)(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);

  const DepthMapping mapping =
      gl::has_clip_control() ? DepthMapping::kReversed : DepthMapping::kForward;
  const HostDepth& host = target.host;
  program_.use();
  program_.set("u_color", 0);
  program_.set("u_depth", 1);
  program_.set("u_corner", glm::vec2(target.x, target.y));
  program_.set("u_texels", glm::vec2(picture.drawn_width(), picture.drawn_height()) /
                               glm::vec2(picture.width(), picture.height()));
  program_.set("u_own", glm::vec2(camera.window_depth(mapping) * glm::dvec2(1, metre)));
  program_.set("u_host", glm::vec4(host.window, host.log_factor, host.reversed ? 0.0 : 1.0));
  program_.set("u_background", background ? 1 : 0);
  program_.set("u_encode", target.color == HostColor::kEncodedByShader ? 1 : 0);
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  return {};
}

}  // namespace mirage

#include "shaders/gl/shadow_map.h"

namespace mirage::gl {
namespace {
constexpr int kShadowMapUnit = 7;  // after those of materials and atlases
}  // namespace

Result<ShadowMap> ShadowMap::create(int edge) {
  ShadowMap map;
  map.edge_ = edge;
  map.depth_ = Texture::create();
  glBindTexture(GL_TEXTURE_2D, map.depth_.id());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT16, edge, edge, 0, GL_DEPTH_COMPONENT,
               GL_UNSIGNED_SHORT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  map.framebuffer_ = Framebuffer::create();
  glBindFramebuffer(GL_FRAMEBUFFER, map.framebuffer_.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map.depth_.id(), 0);
  const GLenum none = GL_NONE;
  glDrawBuffers(1, &none);
  glReadBuffer(GL_NONE);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return make_error(ErrorId::kGraphicsGl, "no shadow map can be made");
  }
  return map;
}

void ShadowMap::begin(const SunFrame& frame) {
  frame_ = frame;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, edge_, edge_);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glClear(GL_DEPTH_BUFFER_BIT);
}

void ShadowMap::use(Program& program, const glm::dvec3& eye) const {
  program.set("u_shadow_map", kShadowMapUnit);
  program.set("u_map_from_relative", frame_.map_from_relative(eye));
  program.set("u_to_sun", glm::vec3(-frame_.forward));
  program.set("u_shadow_texel", glm::vec2(frame_.texel_m(), 1.0 / edge_));
  glActiveTexture(GL_TEXTURE0 + kShadowMapUnit);
  glBindTexture(GL_TEXTURE_2D, depth_.id());
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace mirage::gl

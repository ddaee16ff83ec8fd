#include "shaders/gl/sky_pass.h"

#include <cmath>

namespace mirage::gl {

Result<SkyPass> SkyPass::create() {
  SkyPass pass;
  Result<Program> program = Program::create("common/fullscreen.vert", "common/sky.frag", {});
  if (!program) return program.error();
  pass.program_ = program.take();
  pass.vao_ = VertexArray::create();
  return pass;
}

void SkyPass::draw(const Camera& camera, const Environment& environment) {
  glDisable(GL_DEPTH_TEST);
  fill(camera, environment);
  glEnable(GL_DEPTH_TEST);
}

void SkyPass::draw_behind(const Camera& camera, const Environment& environment,
                          const ViewDepth& view_depth) {
  glDepthRangef(view_depth.farthest(), view_depth.farthest());
  glDepthFunc(GL_EQUAL);
  glDepthMask(GL_FALSE);
  fill(camera, environment);
  glDepthMask(GL_TRUE);
  glDepthFunc(nearer(view_depth.mapping()));
  glDepthRangef(0, 1);
}

void SkyPass::fill(const Camera& camera, const Environment& environment) {
  const double tan_y = std::tan(0.5 * camera.fov_y);
  const double tan_x = tan_y * camera.width / camera.height;
  program_.use();
  program_.set("u_right", glm::vec3(camera.right() * tan_x));
  program_.set("u_up", glm::vec3(camera.up() * tan_y));
  program_.set("u_forward", glm::vec3(camera.forward()));
  program_.set("u_zenith", environment.zenith);
  program_.set("u_horizon", environment.horizon);
  program_.set("u_nadir", environment.nadir);
  glDisable(GL_BLEND);
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace mirage::gl

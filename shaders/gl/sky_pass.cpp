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

Result<void> SkyPass::prepare(const Environment& environment) {
  const StudioFloor& floor = environment.floor;
  if (!(floor.half > 0) || floor.shadow == uploaded_) return {};
  Result<Program> program = Program::create("common/fullscreen.vert", "common/sky.frag", {"FLOOR"});
  if (!program) return program.error();
  over_floor_ = program.take();
  uploaded_ = floor.shadow;
  shadow_ = Texture::create();
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, shadow_.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, StudioFloor::kEdge, StudioFloor::kEdge, 0, GL_RED,
               GL_UNSIGNED_BYTE, floor.shadow.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  }
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  }
  return {};
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
  const glm::dvec2 half = camera.half_tangents();
  const glm::dvec3 right = camera.right() * half.x, up = camera.up() * half.y;
  const glm::dvec2 aside = 2.0 * camera.shift_px / glm::dvec2(camera.width, camera.height);
  const StudioFloor& floor = environment.floor;
  // A view of the scene is drawn before all of the scene is there, and prepared for.
  const bool has_floor = floor.half > 0 && prepare(environment).ok();
  Program& program = has_floor ? over_floor_ : program_;
  program.use();
  program.set("u_right", glm::vec3(right));
  program.set("u_up", glm::vec3(up));
  program.set("u_forward", glm::vec3(camera.forward() - aside.x * right - aside.y * up));
  program.set("u_zenith", environment.zenith);
  program.set("u_horizon", environment.horizon);
  program.set("u_nadir", environment.nadir);
  if (has_floor) {
    program.set("u_floor", glm::vec4(glm::vec3(floor.center - camera.pose.eye), floor.half));
    program.set("u_floor_color", floor.color);
    program.set("u_floor_shadow", 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, shadow_.id());
  }
  glDisable(GL_BLEND);
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace mirage::gl

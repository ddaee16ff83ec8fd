#include "client/draw/caster_pass.h"

#include "client/hold/shadow_cache.h"

namespace mirage {
namespace {

/// Per-instance attributes of caster.vert, locations 1 to 6.
struct CasterInstance {
  glm::vec4 center_scale, right_distance, up_near, window, atlas, far_layer;
};

CasterInstance instance_data(const SceneView& scene, const CasterList& list,
                             const DrawnCaster& drawn) {
  const InstanceView& view = scene.instances[drawn.instance];
  const ShadowRecord& tile = *drawn.tile;
  const Capture& capture = tile.capture;
  const glm::dquat turn(view.world_from_object.rotation);
  const double per_texel = 2.0 * capture.half_tangent / capture.edge;
  const double left = tile.crop.x * per_texel - capture.half_tangent;
  const double top = capture.half_tangent - tile.crop.y * per_texel;
  CasterInstance out;
  out.center_scale =
      glm::vec4(glm::vec3(view.center - list.frame.center), view.world_from_object.scale);
  out.right_distance = glm::vec4(glm::vec3(turn * capture.basis.right), capture.distance);
  out.up_near = glm::vec4(glm::vec3(turn * capture.basis.up), tile.depth_code.near_depth);
  out.window = {left, top, left + tile.crop.w * per_texel, top - tile.crop.h * per_texel};
  out.atlas = {tile.slot.x + 1, tile.slot.y + 1, tile.crop.w, tile.crop.h};
  out.far_layer = {tile.depth_code.far_depth, tile.slot.layer, 0, 0};
  return out;
}

}  // namespace

Result<CasterPass> CasterPass::create() {
  CasterPass pass;
  Result<gl::Program> program =
      gl::Program::create("impostor/caster.vert", "impostor/caster.frag", {});
  if (!program) return program.error();
  pass.program_ = program.take();
  pass.quad_ = gl::VertexArray::create();
  pass.corners_ = gl::Buffer::create();
  pass.instances_ = gl::Buffer::create();
  constexpr float kCorners[] = {0, 0, 1, 0, 0, 1, 1, 1};
  glBindVertexArray(pass.quad_.id());
  glBindBuffer(GL_ARRAY_BUFFER, pass.corners_.id());
  glBufferData(GL_ARRAY_BUFFER, sizeof(kCorners), kCorners, GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  glBindVertexArray(0);
  return pass;
}

void CasterPass::draw(const SceneView& scene, const CasterList& list, GLuint atlas) {
  if (list.tiles.empty()) return;
  std::vector<CasterInstance> instances;
  for (const DrawnCaster& drawn : list.tiles) {
    instances.push_back(instance_data(scene, list, drawn));
  }
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  program_.use();
  program_.set("u_clip_from_relative", list.frame.clip_from_relative(list.frame.center));
  program_.set("u_codes", 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, atlas);
  glBindVertexArray(quad_.id());
  glBindBuffer(GL_ARRAY_BUFFER, instances_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size() * sizeof(CasterInstance)),
               instances.data(), GL_STREAM_DRAW);
  for (GLuint i = 0; i < sizeof(CasterInstance) / sizeof(glm::vec4); ++i) {
    glEnableVertexAttribArray(1 + i);
    glVertexAttribDivisor(1 + i, 1);
    glVertexAttribPointer(1 + i, 4, GL_FLOAT, GL_FALSE, sizeof(CasterInstance),
                          reinterpret_cast<const void*>(i * sizeof(glm::vec4)));
  }
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(instances.size()));
  glBindVertexArray(0);
}

}  // namespace mirage

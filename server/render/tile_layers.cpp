#include "server/render/tile_layers.h"

#include "protocol/impostor/tile.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

constexpr float kStep = kLayerStep / 254.0f;  // the depth buffer holds the depth code (tile_page.h)

void draw_with(std::initializer_list<GLuint> textures, const gl::VertexArray& vao) {
  GLenum unit = GL_TEXTURE0;
  for (const GLuint texture : textures) {
    glActiveTexture(unit++);
    glBindTexture(GL_TEXTURE_2D, texture);
  }
  glBindVertexArray(vao.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace

Result<void> TileLayers::compile(int samples) {
  if (programs_.count(samples) != 0) return {};
  if (!empty_vao_) empty_vao_ = gl::VertexArray::create();
  const std::vector<std::string> defines = {"FACTOR " + std::to_string(samples)};
  Result<gl::Program> floor =
      gl::Program::create("common/fullscreen.vert", "tile/layer_floor.frag", defines);
  if (!floor) return floor.error();
  Result<gl::Program> resolve =
      gl::Program::create("common/fullscreen.vert", "tile/resolve_layers.frag", defines);
  if (!resolve) return resolve.error();
  programs_[samples] = {floor.take(), resolve.take()};
  return {};
}

void TileLayers::begin(const gl::RenderTarget& first, int edge, const RowBand& rows, int samples) {
  const int low = static_cast<int>(rows.low), count = static_cast<int>(rows.rows());
  floor_.bind();
  glViewport(0, 0, edge, edge);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, low, edge, count);
  glDisable(GL_DEPTH_TEST);
  gl::Program& program = programs_.at(samples).floor;
  program.use();
  program.set("u_depth", 0);
  program.set("u_step", kStep);
  draw_with({first.depth()}, empty_vao_);
  peeled_.bind();
  glViewport(0, 0, edge * samples, edge * samples);
  glScissor(0, low * samples, edge * samples, count * samples);
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  meshes_.set_floor(floor_.color(0), samples);
}

void TileLayers::resolve(const gl::RenderTarget& first, int x, int y, int samples) {
  gl::Program& program = programs_.at(samples).resolve;
  program.use();
  program.set("u_color", 0);
  program.set("u_depth", 1);
  program.set("u_floor", 2);
  program.set("u_behind_color", 3);
  program.set("u_behind_depth", 4);
  program.set("u_origin", glm::ivec2(x, y));
  draw_with({first.color(0), first.depth(), floor_.color(0), peeled_.color(0), peeled_.depth()},
            empty_vao_);
}

}  // namespace mirage

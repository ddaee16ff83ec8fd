#include "server/render/tile_page.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>

#include "protocol/capture.h"

namespace mirage {
namespace {

glm::mat4 capture_projection(const Capture& capture) {
  // Near and far hug the bounding sphere: the depth buffer then holds the tile's depth code.
  const double n = capture.distance - capture.radius, f = capture.distance + capture.radius;
  const double half = capture.half_tangent * n;
  const glm::dmat4 clip_from_view = glm::frustum(-half, half, -half, half, n, f);
  const CaptureBasis& b = capture.basis;
  const glm::dmat4 view_from_relative =
      glm::transpose(glm::dmat4(glm::dmat3(b.right, b.up, -b.forward)));
  return glm::mat4(clip_from_view * view_from_relative);
}

}  // namespace

Result<TilePageRenderer> TilePageRenderer::create(const GpuScene& scene, int supersample) {
  TilePageRenderer out(scene, supersample);
  Result<gl::Program> program =
      gl::Program::create("common/fullscreen.vert", "tile/resolve_tile.frag", {});
  if (!program) return program.error();
  out.resolve_ = program.take();
  out.empty_vao_ = gl::VertexArray::create();
  return out;
}

Result<void> TilePageRenderer::warm_up() {
  PagePacker packer(64);
  for (std::uint32_t i = 0; i < scene_->meshes.size(); ++i) {
    Result<void> compiled = meshes_->warm_up(scene_->meshes[i], scene_->materials());
    if (!compiled) return compiled;
  }
  if (!prepare_targets(64)) {
    return make_error(ErrorId::kGraphicsGl, "no framebuffer for tiles can be made");
  }
  supersampled_.bind();
  for (std::uint32_t i = 0; i < scene_->meshes.size(); ++i) {
    TileJob job;
    job.key.object = i;
    job.key.distance = {0, 2};
    draw_tile(job, {0, 0});
  }
  resolve();
  glFinish();
  return {};
}

bool TilePageRenderer::prepare_targets(int edge) {
  if (page_.ok() && page_.width() == edge) return true;
  const int big = edge * supersample_;
  supersampled_ = gl::RenderTarget(big, big, {GL_SRGB8_ALPHA8}, GL_DEPTH_COMPONENT32F);
  page_ = gl::RenderTarget(edge, edge, {GL_SRGB8_ALPHA8, GL_R8}, 0);
  return supersampled_.ok() && page_.ok();
}

void TilePageRenderer::draw_tile(const TileJob& job, PagePacker::Place place) {
  const ObjectDescription& object = scene_->prepared->objects[job.key.object];
  const Capture capture(job.key.cell, job.key.distance, object.radius,
                        tile_edge(job.key.size_class));
  const int s = supersample_, edge = static_cast<int>(capture.edge) * s;
  glViewport(place.x * s, place.y * s, edge, edge);
  glScissor(place.x * s, place.y * s, edge, edge);
  const glm::dvec3 eye = glm::dvec3(object.center) + capture.eye();
  gl::MeshInstance instance;
  instance.position_scale = glm::vec4(glm::vec3(-eye), 1.0f);
  meshes_->begin(capture_projection(capture), gl::light_block(job.lighting, glm::vec3(eye)));
  for (const bool blended : {false, true}) {
    meshes_->draw(scene_->meshes[job.key.object], scene_->materials(), scene_->images, &instance,
                  1, blended);
  }
  meshes_->end();
}

void TilePageRenderer::resolve() {
  page_.bind();
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  resolve_.use();
  resolve_.set("u_color", 0);
  resolve_.set("u_depth", 1);
  resolve_.set("u_factor", supersample_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, supersampled_.color(0));
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, supersampled_.depth());
  glBindVertexArray(empty_vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

const gl::RenderTarget* TilePageRenderer::render(const std::vector<TileJob>& jobs,
                                                 const PagePacker& packer) {
  if (!prepare_targets(packer.page_edge())) return nullptr;
  glEnable(GL_FRAMEBUFFER_SRGB);
  glEnable(GL_DEPTH_CLAMP);
  supersampled_.bind();
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_SCISSOR_TEST);
  // Same object and light together: fewer state changes between tiles.
  std::vector<std::size_t> order(jobs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const TileKey &ka = jobs[a].key, &kb = jobs[b].key;
    return std::tie(ka.object, ka.lighting, a) < std::tie(kb.object, kb.lighting, b);
  });
  for (const std::size_t i : order) draw_tile(jobs[i], packer.places()[i]);
  resolve();
  return &page_;
}

}  // namespace mirage

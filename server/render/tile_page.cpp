#include "server/render/tile_page.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>

#include "protocol/capture.h"

namespace mirage {
namespace {

// The edge of an alpha test is a texture's, not a triangle's, and foliage has one in every pixel:
// settled, 3 samples an axis are worth 1.1 dB over 2 on the reference tree, 4 no more than 3.
constexpr int kAlphaTestSupersample = 3;
constexpr std::uint32_t kLargestFineTile = 1024;  // larger ones would take a target of 300 MB

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
  for (std::uint32_t i = 0; i < scene_->meshes.size(); ++i) {
    Result<void> compiled = meshes_->warm_up(scene_->meshes[i], scene_->materials());
    if (!compiled) return compiled;
  }
  if (!prepare_targets(64, 16 * std::max(supersample_, kAlphaTestSupersample))) {
    return make_error(ErrorId::kGraphicsGl, "no framebuffer for tiles can be made");
  }
  for (std::uint32_t i = 0; i < scene_->meshes.size(); ++i) {
    TileJob job;
    job.key.object = i;
    job.key.distance = {0, 2};
    draw_tile(job);
    resolve(job, {0, 0});
  }
  glFinish();
  return {};
}

int TilePageRenderer::samples(const TileJob& job) const {
  const bool tested = scene_->prepared->objects[job.key.object].needs & kNeedAlphaMask;
  const bool fine = tested && tile_edge(job.key.size_class) <= kLargestFineTile;
  return fine ? std::max(supersample_, kAlphaTestSupersample) : supersample_;
}

bool TilePageRenderer::prepare_targets(int page_edge, int big) {
  if (!supersampled_.ok() || supersampled_.width() < big) {
    supersampled_ = gl::RenderTarget(big, big, {GL_SRGB8_ALPHA8}, GL_DEPTH_COMPONENT32F);
  }
  if (!page_.ok() || page_.width() != page_edge) {
    page_ = gl::RenderTarget(page_edge, page_edge, {GL_SRGB8_ALPHA8, GL_R8}, 0);
  }
  return supersampled_.ok() && page_.ok();
}

void TilePageRenderer::draw_tile(const TileJob& job) {
  const ObjectDescription& object = scene_->prepared->objects[job.key.object];
  const Capture capture(job.key.cell, job.key.distance, object.radius,
                        tile_edge(job.key.size_class));
  const int edge = static_cast<int>(capture.edge) * samples(job);
  supersampled_.bind();
  glViewport(0, 0, edge, edge);
  glScissor(0, 0, edge, edge);
  glEnable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const glm::dvec3 eye = glm::dvec3(object.center) + capture.eye();
  gl::MeshInstance instance;
  instance.position_scale = glm::vec4(glm::vec3(-eye), 1.0f);
  meshes_->begin(capture_projection(capture), gl::light_block(job.lighting, glm::vec3(eye)));
  for (const bool blended : {false, true}) {
    meshes_->draw(scene_->meshes[job.key.object], scene_->materials(), scene_->images, &instance, 1,
                  blended);
  }
  meshes_->end();
}

void TilePageRenderer::resolve(const TileJob& job, PagePacker::Place place) {
  const int edge = static_cast<int>(tile_edge(job.key.size_class));
  page_.bind();
  glViewport(place.x, place.y, edge, edge);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  resolve_.use();
  resolve_.set("u_color", 0);
  resolve_.set("u_depth", 1);
  resolve_.set("u_factor", samples(job));
  resolve_.set("u_origin", glm::ivec2(place.x, place.y));
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
  int largest = 0;
  for (const TileJob& job : jobs) {
    largest = std::max(largest, static_cast<int>(tile_edge(job.key.size_class)) * samples(job));
  }
  if (!prepare_targets(packer.page_edge(), largest)) return nullptr;
  glEnable(GL_FRAMEBUFFER_SRGB);
  glEnable(GL_DEPTH_CLAMP);
  // Same object and light together: fewer state changes between tiles.
  std::vector<std::size_t> order(jobs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const TileKey &ka = jobs[a].key, &kb = jobs[b].key;
    return std::tie(ka.object, ka.lighting, a) < std::tie(kb.object, kb.lighting, b);
  });
  for (const std::size_t i : order) {
    draw_tile(jobs[i]);
    resolve(jobs[i], packer.places()[i]);
  }
  return &page_;
}

}  // namespace mirage

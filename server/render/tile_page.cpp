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
  for (const bool relit : {false, true}) {
    Result<gl::Program> program =
        gl::Program::create("common/fullscreen.vert", "tile/resolve_tile.frag",
                            relit ? std::vector<std::string>{"RELIT"} : std::vector<std::string>{});
    if (!program) return program.error();
    Path& path = relit ? out.relit_ : out.lit_;
    path.resolve = program.take();
    path.meshes =
        std::make_unique<gl::MeshPass>(relit ? gl::MeshOutput::kSurface : gl::MeshOutput::kColor);
  }
  out.empty_vao_ = gl::VertexArray::create();
  return out;
}

Result<void> TilePageRenderer::warm_up() {
  for (std::uint32_t i = 0; i < scene_->meshes.size(); ++i) {
    for (Path* path : {&lit_, &relit_}) {
      if (path == &relit_ && !can_relight(scene_->prepared->objects[i].needs)) continue;
      Result<void> compiled = path->meshes->warm_up(scene_->meshes[i], scene_->materials(), false);
      if (!compiled) return compiled;
      for (const gl::GpuMesh& lod : scene_->tile_lods[i]) {
        compiled = path->meshes->warm_up(lod, scene_->materials(), false);
        if (!compiled) return compiled;
      }
    }
  }
  if (!prepare_targets(lit_, 64, 16 * std::max(supersample_, kAlphaTestSupersample))) {
    return make_error(ErrorId::kGraphicsGl, "no framebuffer for tiles can be made");
  }
  for (std::uint32_t i = 0; i < scene_->meshes.size(); ++i) {
    TileJob job;
    job.key.object = i;
    job.key.phase = scene_->prepared->objects[i].motion.moving() ? 1 : kStaticPhase;
    job.key.distance = {0, 2};
    draw_tile(job);
    resolve(job, lit_.page, {0, 0});
  }
  glFinish();
  return {};
}

int TilePageRenderer::samples(const TileJob& job) const {
  const bool tested = scene_->prepared->objects[job.key.object].needs & kNeedAlphaMask;
  const bool fine = tested && tile_edge(job.key.size_class) <= kLargestFineTile;
  return fine ? std::max(supersample_, kAlphaTestSupersample) : supersample_;
}

bool TilePageRenderer::prepare_targets(Path& path, int page_edge, int big) {
  std::vector<GLenum> drawn = {GL_SRGB8_ALPHA8}, page = {GL_SRGB8_ALPHA8, GL_R8};
  if (&path == &relit_) {
    drawn.insert(drawn.end(), {GL_RGBA16F, GL_RGBA8});
    page.push_back(GL_RGBA8);
  }
  if (!path.supersampled.ok() || path.supersampled.width() < big) {
    path.supersampled = gl::RenderTarget(big, big, drawn, GL_DEPTH_COMPONENT32F);
  }
  if (!path.page.ok() || path.page.width() != page_edge) {
    path.page = gl::RenderTarget(page_edge, page_edge, page, 0);
  }
  return path.supersampled.ok() && path.page.ok();
}

Capture TilePageRenderer::capture_of(const TileJob& job) const {
  return Capture(job.key.cell, job.key.distance, scene_->prepared->objects[job.key.object].radius,
                 tile_edge(job.key.size_class));
}

void TilePageRenderer::draw_tile(const TileJob& job) {
  const ObjectDescription& object = scene_->prepared->objects[job.key.object];
  const Capture capture = capture_of(job);
  const int edge = static_cast<int>(capture.edge) * samples(job);
  Path& path = path_of(job);
  path.supersampled.bind();
  glViewport(0, 0, edge, edge);
  glScissor(0, 0, edge, edge);
  glEnable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const glm::dvec3 eye = glm::dvec3(object.center) + capture.eye();
  path.meshes->set_stroke(static_cast<float>(samples(job)));
  path.meshes->begin(capture_projection(capture), gl::light_block(job.lighting, glm::vec3(eye)));
  if (const InstanceGroup* group = scene_->prepared->group(job.key.object)) {
    draw_group(*path.meshes, *group, capture, eye);
  } else {
    gl::MeshInstance instance;
    instance.position_scale = glm::vec4(glm::vec3(-eye), 1.0f);
    const double clip_time = phase_time(static_cast<Phase>(job.key.phase), object.motion.clip_s);
    const gl::GpuMesh& mesh = object.motion.moving()
                                  ? scene_->posed_mesh(job.key.object, clip_time)
                                  : scene_->mesh_for_tile(job.key.object, capture);
    for (const bool blended : {false, true}) {
      path.meshes->draw(mesh, scene_->materials(), scene_->images, &instance, 1, blended);
    }
  }
  path.meshes->end();
}

void TilePageRenderer::draw_group(gl::MeshPass& meshes, const InstanceGroup& group,
                                  const Capture& capture, const glm::dvec3& eye) {
  const std::vector<Instance>& instances = scene_->prepared->scene.instances;
  struct Batch {
    const gl::GpuMesh* mesh;
    std::vector<gl::MeshInstance> members;
  };
  std::vector<Batch> batches;  // in the order of the instances: the same every time
  for (const std::uint32_t i : group.leaves) {
    const Similarity& m = instances[i].world_from_object;
    gl::MeshInstance data;
    data.rotation = {m.rotation.x, m.rotation.y, m.rotation.z, m.rotation.w};
    data.position_scale = glm::vec4(glm::vec3(m.position - group.center - eye), m.scale);
    const gl::GpuMesh* mesh = &scene_->mesh_for_group(instances[i].object, m.scale, capture);
    auto at = std::find_if(batches.begin(), batches.end(),
                           [&](const Batch& batch) { return batch.mesh == mesh; });
    if (at == batches.end()) at = batches.insert(batches.end(), Batch{mesh, {}});
    at->members.push_back(data);
  }
  for (const Batch& batch : batches) {
    meshes.draw(*batch.mesh, scene_->materials(), scene_->images, batch.members.data(),
                batch.members.size(), false);
  }
}

void TilePageRenderer::resolve(const TileJob& job, const gl::RenderTarget& page,
                               PagePacker::Place place) {
  const int edge = static_cast<int>(tile_edge(job.key.size_class));
  Path& path = path_of(job);
  page.bind();
  glViewport(place.x, place.y, edge, edge);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  path.resolve.use();
  path.resolve.set("u_color", 0);
  path.resolve.set("u_depth", 1);
  path.resolve.set("u_factor", samples(job));
  path.resolve.set("u_origin", glm::ivec2(place.x, place.y));
  std::vector<GLuint> inputs = {path.supersampled.color(0), path.supersampled.depth()};
  if (&path == &relit_) {
    const CaptureBasis basis = capture_of(job).basis;
    path.resolve.set("u_normal", 2);
    path.resolve.set("u_material", 3);
    path.resolve.set("u_right", glm::vec3(basis.right));
    path.resolve.set("u_up", glm::vec3(basis.up));
    inputs.insert(inputs.end(), {path.supersampled.color(1), path.supersampled.color(2)});
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    glBindTexture(GL_TEXTURE_2D, inputs[i]);
  }
  glBindVertexArray(empty_vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

const gl::RenderTarget* TilePageRenderer::render(const std::vector<TileJob>& jobs,
                                                 const PagePacker& packer) {
  int largest = 0, largest_relit = 0;
  for (const TileJob& job : jobs) {
    int& of_kind = &path_of(job) == &relit_ ? largest_relit : largest;
    of_kind = std::max(of_kind, static_cast<int>(tile_edge(job.key.size_class)) * samples(job));
  }
  const int edge = packer.page_edge();
  if (largest > 0 && !prepare_targets(lit_, edge, largest)) return nullptr;
  if (largest_relit > 0 && !prepare_targets(relit_, edge, largest_relit)) return nullptr;
  const gl::RenderTarget& page = largest_relit > 0 ? relit_.page : lit_.page;
  glEnable(GL_FRAMEBUFFER_SRGB);
  glEnable(GL_DEPTH_CLAMP);
  // Same object and light together: fewer state changes between tiles.
  std::vector<std::size_t> order(jobs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const TileKey &ka = jobs[a].key, &kb = jobs[b].key;
    return std::tie(ka.object, ka.phase, ka.lighting, a) <
           std::tie(kb.object, kb.phase, kb.lighting, b);
  });
  for (const std::size_t i : order) {
    draw_tile(jobs[i]);
    resolve(jobs[i], page, packer.places()[i]);
  }
  return &page;
}

}  // namespace mirage

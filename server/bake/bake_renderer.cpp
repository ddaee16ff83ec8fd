#include "server/bake/bake_renderer.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "protocol/impostor/lod.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

constexpr int kWidestStrip = 8192;  // texels
// Colour, normal, material, height.
const std::vector<GLenum> kDrawnFormats = {GL_RGBA16F, GL_RGBA16F, GL_RGBA8};
const std::vector<GLenum> kStripFormats = {GL_RGBA16F, GL_RGBA16F, GL_RGBA16F, GL_R32F};

constexpr GLenum kAllDrawn[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
constexpr GLenum kNothing[] = {GL_NONE};
// From this alpha, more is seen of a blended surface than of what is behind.
constexpr float kHidesMore = 0.5f;

// Positions are relative to the centre. Depth is 0 at the sphere's near end and 1 at its far end.
glm::mat4 frame_projection(const FrameBasis& basis, double radius) {
  const glm::dmat4 view_from_relative =
      glm::transpose(glm::dmat4(glm::dmat3(basis.right, basis.up, basis.toward)));
  return glm::mat4(glm::ortho(-radius, radius, -radius, radius, -radius, radius) *
                   view_from_relative);
}

std::vector<float> read(const gl::RenderTarget& target, int attachment, int width, int height,
                        GLenum format, int channels) {
  std::vector<float> out(std::size_t(width) * height * channels);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer());
  glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(attachment));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, format, GL_FLOAT, out.data());
  return out;
}

Error no_target(int edge, int samples) {
  return make_error(ErrorId::kGraphicsGl,
                    "no target for a frame of " + std::to_string(edge) + " texels with " +
                        std::to_string(samples) + " x " + std::to_string(samples) + " samples",
                    "a smaller --size or fewer --samples need less graphics memory");
}

}  // namespace

/// Frames side by side, as read back.
struct BakeRenderer::Strip {
  int width = 0, edge = 0;
  std::vector<float> color, normal, material, height;

  Strip(const gl::RenderTarget& target, int frames, int frame_edge)
      : width(frames * frame_edge),
        edge(frame_edge),
        color(read(target, 0, width, edge, GL_RGBA, 4)),
        normal(read(target, 1, width, edge, GL_RGBA, 4)),
        material(read(target, 2, width, edge, GL_RGBA, 4)),
        height(read(target, 3, width, edge, GL_RED, 1)) {}

  // Puts frame `n` of the strip into the master at texel `to`, top row first.
  void put(int n, BakeMaster& master, std::size_t to) const {
    for (int y = edge - 1; y >= 0; --y) {
      for (int x = 0; x < edge; ++x, ++to) {
        const std::size_t at = std::size_t(y) * width + std::size_t(n) * edge + x;
        const float *c = &color[4 * at], *v = &normal[4 * at], *m = &material[4 * at];
        master.color[to] = {c[0], c[1], c[2], c[3]};
        master.normal[to] = {v[0], v[1], v[2]};
        master.orm[to] = {m[2], m[1], m[0]};
        master.depth[to] = height[at];
      }
    }
  }
};

BakeRenderer::BakeRenderer(const GpuScene& scene)
    : scene_(&scene), empty_vao_(gl::VertexArray::create()) {
  meshes_.set_probe(scene.probe_map());
  meshes_.set_surroundings(scene.prepared->scene.environment);
}
BakeRenderer::~BakeRenderer() = default;

Result<void> BakeRenderer::prepare(const BakeSubject& subject, int edge, int samples) {
  if (samples_ != samples) {
    Result<gl::Program> made = gl::Program::create("common/fullscreen.vert", "bake/bake_frame.frag",
                                                   {"FACTOR " + std::to_string(samples)});
    if (!made) return made.error();
    resolve_ = made.take();
    samples_ = samples;
  }
  const int big = edge * samples;
  if (drawn_.width() != big) {
    drawn_ = gl::RenderTarget();  // frees the old one first
    drawn_ = gl::RenderTarget(big, big, kDrawnFormats, GL_DEPTH_COMPONENT32F);
    if (!drawn_.ok()) return no_target(edge, samples);
  }
  if (subject.blended && fronts_alone_.width() != big) {
    fronts_alone_ = gl::RenderTarget();
    fronts_alone_ = gl::RenderTarget(big, big, {}, GL_DEPTH_COMPONENT32F);
    if (!fronts_alone_.ok()) return no_target(edge, samples);
  }
  return {};
}

void BakeRenderer::draw_parts(gl::MeshPass& pass, const BakeSubject& subject, const glm::dvec3& eye,
                              double allowed, bool blended) {
  for (std::uint32_t i = 0; i < subject.parts.size(); ++i) {
    const SubjectPart& part = subject.parts[i];
    const ObjectDescription& object = scene_->prepared->objects[part.object];
    const std::size_t level = lod_within(object.lods, allowed / double{part.placed.scale});
    const gl::GpuMesh& mesh = object.motion.moving() ? scene_->posed_mesh(part.object, 0)
                                                     : scene_->level(part.object, level);
    const gl::MeshInstance instance = gl::mesh_instance(part.placed, eye, i);
    pass.draw(mesh, scene_->materials(), scene_->images, &instance, 1, blended);
  }
}

void BakeRenderer::draw_frame(const BakeSubject& subject, const glm::mat4& clip_from_relative,
                              const glm::dvec3& eye, int edge, int samples, double allowed) {
  drawn_.bind();
  glViewport(0, 0, edge * samples, edge * samples);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  meshes_.set_stroke(static_cast<float>(samples));
  meshes_.begin(clip_from_relative, {});
  for (const bool blended : {false, true}) draw_parts(meshes_, subject, eye, allowed, blended);
  meshes_.end();
  if (!subject.blended) return;
  // Blended surfaces have written no depth. Those that hide more than they show write it here.
  fronts_.set_stroke(static_cast<float>(samples));
  glDrawBuffers(1, kNothing);
  draw_fronts(subject, clip_from_relative, eye, allowed, kHidesMore);
  glDrawBuffers(3, kAllDrawn);
  // All of them write it here. It counts where nothing else has any, so that what stands behind
  // glass keeps its place.
  fronts_alone_.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  draw_fronts(subject, clip_from_relative, eye, allowed, 0);
}

void BakeRenderer::draw_fronts(const BakeSubject& subject, const glm::mat4& clip_from_relative,
                               const glm::dvec3& eye, double allowed, float least_alpha) {
  fronts_.set_least_alpha(least_alpha);
  fronts_.begin(clip_from_relative, {});
  draw_parts(fronts_, subject, eye, allowed, true);
  fronts_.end();
}

void BakeRenderer::resolve(int x, int edge, bool blended) {
  strip_.bind();
  glViewport(x, 0, edge, edge);
  glDisable(GL_DEPTH_TEST);
  resolve_.use();
  resolve_.set("u_color", 0);
  resolve_.set("u_normal", 1);
  resolve_.set("u_material", 2);
  resolve_.set("u_depth", 3);
  resolve_.set("u_fronts", 4);
  resolve_.set("u_origin", glm::ivec2(x, 0));
  const GLuint inputs[] = {drawn_.color(0), drawn_.color(1), drawn_.color(2), drawn_.depth(),
                           blended ? fronts_alone_.depth() : drawn_.depth()};
  for (GLenum i = 0; i < 5; ++i) {
    glActiveTexture(GL_TEXTURE0 + i);
    glBindTexture(GL_TEXTURE_2D, inputs[i]);
  }
  glBindVertexArray(empty_vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

Result<BakeMaster> BakeRenderer::bake(const BakeSubject& subject, const BakeShot& shot,
                                      const std::function<bool(double)>& told) {
  if (const Result<void> ready = prepare(subject, shot.tile, shot.samples); !ready) {
    return ready.error();
  }
  const int across = std::clamp(kWidestStrip / shot.tile, 1, shot.grid);
  strip_ = gl::RenderTarget(across * shot.tile, shot.tile, kStripFormats, 0);
  if (!strip_.ok()) return no_target(shot.tile, shot.samples);
  BakeMaster master;
  master.layout = shot.layout;
  master.roll = shot.roll;
  master.grid = shot.grid;
  master.tile = shot.tile;
  master.center = shot.center;
  master.radius = shot.radius;
  master.clear();
  glDisable(GL_FRAMEBUFFER_SRGB);
  glDisable(GL_DEPTH_CLAMP);
  const double allowed = kTileErrorTexels * 2 * shot.radius / shot.tile;
  const int frames = shot.grid * shot.grid;
  for (int first = 0; first < frames; first += across) {
    const int count = std::min(across, frames - first);
    for (int n = 0; n < count; ++n) {
      const FrameBasis basis = master.basis((first + n) % shot.grid, (first + n) / shot.grid);
      draw_frame(subject, frame_projection(basis, shot.radius), shot.center, shot.tile,
                 shot.samples, allowed);
      resolve(n * shot.tile, shot.tile, subject.blended);
    }
    const Strip strip(strip_, count, shot.tile);
    const std::size_t texels = std::size_t(shot.tile) * shot.tile;
    for (int n = 0; n < count; ++n) strip.put(n, master, (std::size_t(first) + n) * texels);
    if (told && !told(double(first + count) / frames)) {
      return make_error(ErrorId::kUsage, "the bake of '" + subject.name + "' was ended");
    }
  }
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "GL error " + std::to_string(error) + " in a bake");
  }
  return master;
}

Result<BakeRenderer::Picture> BakeRenderer::draw(const BakeSubject& subject,
                                                 const glm::mat4& clip_from_relative,
                                                 const glm::dvec3& eye, int edge, int samples) {
  if (const Result<void> ready = prepare(subject, edge, samples); !ready) return ready.error();
  strip_ = gl::RenderTarget(edge, edge, kStripFormats, 0);
  if (!strip_.ok()) return no_target(edge, samples);
  glDisable(GL_FRAMEBUFFER_SRGB);
  draw_frame(subject, clip_from_relative, eye, edge, samples, 0);
  resolve(0, edge, subject.blended);
  BakeMaster one;
  one.grid = 1;
  one.tile = edge;
  one.clear();
  Strip(strip_, 1, edge).put(0, one, 0);
  return Picture{edge, std::move(one.color), std::move(one.normal)};
}

}  // namespace mirage

#include "server/render/reference_renderer.h"

#include <algorithm>

#include "protocol/impostor/motion.h"
#include "protocol/impostor/object_proxy.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/frame_pieces.h"
#include "server/render/gpu_scene.h"
#include "server/render/scene_shadow.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

const std::vector<GLenum> kKeptFormats = {GL_SRGB8_ALPHA8, GL_R32F, GL_R32UI};

constexpr GLenum kColorNoId[] = {GL_COLOR_ATTACHMENT0, GL_NONE};
constexpr GLenum kIdOnly[] = {GL_NONE, GL_COLOR_ATTACHMENT1};
constexpr GLenum kColorAndId[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};

// Samples of a target, independent of the picture: making a larger one would take longer than a
// slice.
constexpr std::uint32_t kTargetSamples = 1u << 20;

// Returns the rows of a picture that a target holds.
std::uint32_t rows_of_target(const SceneShot& shot) {
  const std::uint32_t row = shot.camera.width * shot.supersample * shot.supersample;
  return std::clamp(kTargetSamples / row, 1u, shot.camera.height);
}

/// How the bound framebuffer has a plane.
struct PlaneSource {
  GLenum attachment = GL_COLOR_ATTACHMENT0, format = GL_RGBA, type = GL_UNSIGNED_BYTE;
  std::size_t components = 4;  ///< elements of a pixel
};

/// Appends a band to a plane whose rows go down; `low` is the band's row in the framebuffer. Memory
/// grows with the rows, because touching that of a large picture at once would take longer than a
/// slice.
template <typename T>
void append_rows(std::vector<T>& plane, const PlaneSource& source, const RowBand& band, int low,
                 int width) {
  const std::size_t row = static_cast<std::size_t>(width) * source.components;
  std::vector<T> rows(row * band.rows());
  glReadBuffer(source.attachment);
  glReadPixels(0, low, width, static_cast<GLsizei>(band.high - band.low), source.format,
               source.type, rows.data());
  for (std::size_t y = band.rows(); y-- > 0;) {
    const auto from = rows.begin() + static_cast<std::ptrdiff_t>(y * row);
    plane.insert(plane.end(), from, from + static_cast<std::ptrdiff_t>(row));
  }
}

}  // namespace

/// The state of a picture under way.
struct ReferenceRenderer::Progress {
  Progress(const GpuScene& scene, const SceneShot& of, double slice)
      : shot(of),
        slice_samples(slice),
        lights(gl::light_block(of.lighting, of.camera.pose.eye)),
        pieces(scene, of),
        target_rows(rows_of_target(of)) {
    const std::size_t pixels = std::size_t{of.camera.width} * of.camera.height;
    frame.rgba.reserve(pixels * 4);
    frame.depth.reserve(pixels);
    frame.ids.reserve(pixels);
    band.low = of.camera.height;
    next_band();
  }
  /// Selects the rows below the last band, within one target.
  void next_band() {
    band.high = band.low;
    if (done()) return;
    first_row = (band.high - 1) / target_rows * target_rows;
    const std::uint32_t most = pieces.rows_of_band(slice_samples);
    band.low = std::max(first_row, band.high - std::min(most, band.high));
    begun = false;
    steps.clear();
    steps_done = 0;
  }
  bool done() const { return band.high == 0; }
  int samples() const { return static_cast<int>(shot.supersample); }
  int width() const { return static_cast<int>(shot.camera.width); }
  /// Lowest row of the band in the targets.
  int low() const { return static_cast<int>(band.low - first_row); }
  int rows() const { return static_cast<int>(band.high - band.low); }
  double band_samples() const { return double{1} * width() * rows() * samples() * samples(); }

  const SceneShot shot;
  const double slice_samples;
  const gl::LightBlock lights;
  const FramePieces pieces;
  const std::uint32_t target_rows;
  std::uint32_t first_row = 0;  ///< picture row at the targets' first row
  RowBand band;
  struct Step {
    enum class Kind : std::uint8_t { kOpaque, kBlended, kFront } kind;
    FramePiece piece;
  };
  std::vector<Step> steps;  ///< of the band, filled when it begins
  std::size_t steps_done = 0;
  bool begun = false;
  SceneFrame frame;
};

ReferenceRenderer::ReferenceRenderer(ReferenceRenderer&& other) noexcept = default;
ReferenceRenderer& ReferenceRenderer::operator=(ReferenceRenderer&& other) noexcept = default;
ReferenceRenderer::~ReferenceRenderer() = default;

ReferenceRenderer::ReferenceRenderer(const GpuScene& scene)
    : scene_(&scene),
      meshes_(std::make_unique<gl::MeshPass>(gl::MeshOutput::kId)),
      fronts_(std::make_unique<gl::MeshPass>(gl::MeshOutput::kFront)) {}

Result<ReferenceRenderer> ReferenceRenderer::create(const GpuScene& scene, SceneShadow* shadow) {
  ReferenceRenderer out(scene);
  out.shadow_ = shadow;
  out.meshes_->set_probe(scene.probe_map());
  out.meshes_->set_surroundings(scene.prepared->scene.environment);
  Result<gl::SkyPass> sky = gl::SkyPass::create();
  if (!sky) return sky.error();
  out.sky_ = std::move(*sky);
  Result<void> prepared = out.sky_.prepare(scene.prepared->scene.environment);
  if (!prepared) return prepared.error();
  Result<gl::Program> resolve =
      gl::Program::create("common/fullscreen.vert", "tile/resolve_reference.frag", {});
  if (!resolve) return resolve.error();
  out.resolve_ = resolve.take();
  out.empty_vao_ = gl::VertexArray::create();
  return out;
}

Result<void> ReferenceRenderer::warm_up() {
  const PreparedScene& prepared = *scene_->prepared;
  for (std::size_t object = 0; object < scene_->meshes.size(); ++object) {
    for (gl::MeshPass* pass : {meshes_.get(), fronts_.get()}) {
      if (pass == fronts_.get() && !(prepared.objects[object].needs & kNeedBlend)) continue;
      Result<void> compiled = pass->warm_up(scene_->meshes[object], scene_->materials(), false);
      if (!compiled) return compiled;
    }
  }
  return {};
}

std::vector<GLenum> ReferenceRenderer::drawn_formats() const {
  return {gl::color_format(scene_->prepared->blends()), GL_R32UI};
}

std::size_t ReferenceRenderer::gpu_bytes(const SceneShot& shot) const {
  const int w = static_cast<int>(shot.camera.width), rows = static_cast<int>(rows_of_target(shot));
  const int s = static_cast<int>(shot.supersample);
  return gl::target_bytes(w * s, rows * s, drawn_formats(), GL_DEPTH_COMPONENT32F) +
         gl::target_bytes(w, rows, kKeptFormats, 0);
}

void ReferenceRenderer::drop() { progress_.reset(); }

Result<void> ReferenceRenderer::begin(const SceneShot& shot, double slice_samples) {
  drop();
  auto next = std::make_unique<Progress>(*scene_, shot, slice_samples);
  const int w = static_cast<int>(shot.camera.width), rows = static_cast<int>(next->target_rows);
  const int s = next->samples();
  GLint most[2] = {};  // a larger viewport is clipped silently
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, most);
  if (w * s > most[0] || static_cast<int>(shot.camera.height) * s > most[1]) {
    return make_error(ErrorId::kGraphicsGl, "a full render is too large for this device");
  }
  const bool fits = drawn_.ok() && kept_.ok() && drawn_.width() == w * s &&
                    drawn_.height() == rows * s && kept_.width() == w;
  if (!fits) {
    drawn_ = gl::RenderTarget();  // frees the old one first: never both in memory
    drawn_ = gl::RenderTarget(w * s, rows * s, drawn_formats(), GL_DEPTH_COMPONENT32F);
    kept_ = gl::RenderTarget();
    kept_ = gl::RenderTarget(w, rows, kKeptFormats, 0);
  }
  if (!drawn_.ok() || !kept_.ok()) {
    return make_error(ErrorId::kGraphicsGl, "a full render is too large for this device");
  }
  progress_ = std::move(next);
  return {};
}

void ReferenceRenderer::aim_at_band() const {
  const Progress& p = *progress_;
  const int s = p.samples(), w = p.width() * s;
  drawn_.bind();
  glViewport(0, -static_cast<GLint>(p.first_row) * s, w,
             static_cast<GLsizei>(p.shot.camera.height) * s);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, p.low() * s, w, p.rows() * s);
}

void ReferenceRenderer::begin_band(float far_depth) {
  using Kind = Progress::Step::Kind;
  Progress& p = *progress_;
  const GLuint no_id[4] = {0, 0, 0, 0};
  glDrawBuffers(2, kColorAndId);
  glClearBufferuiv(GL_COLOR, 1, no_id);
  glDepthMask(GL_TRUE);
  glClearBufferfv(GL_DEPTH, 0, &far_depth);
  glDrawBuffers(2, kColorNoId);
  sky_.draw(p.shot.camera, scene_->prepared->scene.environment);
  for (FramePiece& piece : p.pieces.opaque(p.band)) {
    p.steps.push_back({Kind::kOpaque, std::move(piece)});
  }
  // Depth and id are those of the nearest surface, blended or not, which is written last.
  for (const Kind kind : {Kind::kBlended, Kind::kFront}) {
    for (FramePiece& piece : p.pieces.blended(p.band)) p.steps.push_back({kind, std::move(piece)});
  }
  p.begun = true;
}

double ReferenceRenderer::draw_pieces(double most, DepthMapping mapping) {
  using Kind = Progress::Step::Kind;
  Progress& p = *progress_;
  const glm::mat4 clip = p.shot.camera.clip_from_relative(mapping);
  double work = 0;
  gl::MeshPass* pass = nullptr;
  for (std::optional<Kind> last; work < most && p.steps_done < p.steps.size(); ++p.steps_done) {
    const auto& [kind, piece] = p.steps[p.steps_done];
    if (kind != last) {
      if (pass) pass->end();
      glDrawBuffers(2, kind == Kind::kOpaque    ? kColorAndId
                       : kind == Kind::kBlended ? kColorNoId
                                                : kIdOnly);
      pass = kind == Kind::kFront ? fronts_.get() : meshes_.get();
      pass->begin(clip, p.lights, mapping);
      last = kind;
    }
    draw_piece(*pass, piece, kind != Kind::kOpaque);
    work += piece.work;
  }
  if (pass) pass->end();
  return work;
}

void ReferenceRenderer::draw_piece(gl::MeshPass& pass, const FramePiece& piece, bool blended) {
  const SceneShot& shot = progress_->shot;
  const PreparedScene& prepared = *scene_->prepared;
  const ObjectDescription& object = prepared.objects[piece.object];
  const MotionProfile& motion = object.motion;
  std::vector<gl::MeshInstance> instances;
  for (const std::uint32_t i : piece.instances) {
    const Instance& instance = prepared.scene.instances[i];
    const double time =
        wrap_clip(shot.time_s + double{instance.clip_offset_s}, object.track.clip_s);
    const Similarity placed = on_track(instance.world_from_object, object.track, time);
    instances.push_back(gl::mesh_instance(placed, shot.camera.pose.eye, i));
  }
  const float offset_s = prepared.scene.instances[piece.instances.front()].clip_offset_s;
  const gl::GpuMesh& mesh =
      motion.moving() ? scene_->posed_mesh(piece.object,
                                           wrap_clip(shot.time_s + double{offset_s}, motion.clip_s))
                      : scene_->level(piece.object, piece.level);
  pass.draw(mesh, scene_->materials(), scene_->images, instances.data(), instances.size(), blended);
}

void ReferenceRenderer::finish_band(const gl::ViewDepth& view_depth) {
  Progress& p = *progress_;
  kept_.bind();
  glScissor(0, p.low(), p.width(), p.rows());
  glDisable(GL_DEPTH_TEST);
  resolve_.use();
  const GLuint inputs[3] = {drawn_.color(0), drawn_.depth(), drawn_.color(1)};
  for (int i = 0; i < 3; ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    glBindTexture(GL_TEXTURE_2D, inputs[i]);
  }
  resolve_.set("u_color", 0);
  resolve_.set("u_depth", 1);
  resolve_.set("u_id", 2);
  resolve_.set("u_factor", p.samples());
  resolve_.set("u_window_depth", glm::vec2(p.shot.camera.window_depth(view_depth.mapping())));
  resolve_.set("u_farthest", view_depth.farthest());
  glBindVertexArray(empty_vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);

  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  const int w = p.width(), low = p.low();
  append_rows(p.frame.rgba, {}, p.band, low, w);
  append_rows(p.frame.depth, {GL_COLOR_ATTACHMENT1, GL_RED, GL_FLOAT, 1}, p.band, low, w);
  append_rows(p.frame.ids, {GL_COLOR_ATTACHMENT2, GL_RED_INTEGER, GL_UNSIGNED_INT, 1}, p.band, low,
              w);
}

std::optional<SceneFrame> ReferenceRenderer::draw_slice() {
  Progress& p = *progress_;
  meshes_->set_shadow(shadow_ ? shadow_->map_for(p.shot.lighting) : nullptr,
                      p.shot.camera.pose.eye);
  const Environment& environment = scene_->prepared->scene.environment;
  meshes_->set_fog(environment.horizon, environment.fog_density);
  meshes_->set_stroke(static_cast<float>(p.samples()));
  glEnable(GL_FRAMEBUFFER_SRGB);
  glDisable(GL_DEPTH_CLAMP);
  const gl::ViewDepth view_depth;
  for (double work = 0; work < p.slice_samples && !p.done();) {
    aim_at_band();
    if (!p.begun) begin_band(view_depth.farthest());
    work += draw_pieces(p.slice_samples - work, view_depth.mapping());
    if (p.steps_done < p.steps.size()) break;
    work += p.band_samples();
    finish_band(view_depth);
    p.next_band();
  }
  glDisable(GL_SCISSOR_TEST);
  glFinish();
  if (!p.done()) return std::nullopt;
  SceneFrame frame = std::move(p.frame);
  drop();
  return frame;
}

Result<SceneFrame> ReferenceRenderer::draw(const SceneShot& shot) {
  if (const Result<void> begun = begin(shot); !begun) return begun.error();
  for (;;) {
    if (std::optional<SceneFrame> frame = draw_slice()) return std::move(*frame);
  }
}

}  // namespace mirage

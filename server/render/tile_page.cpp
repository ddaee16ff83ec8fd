#include "server/render/tile_page.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>

#include "protocol/impostor/capture.h"
#include "protocol/impostor/sun_frame.h"
#include "protocol/impostor/tile_key.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/render/scene_shadow.h"
#include "server/render/tile_layers.h"
#include "server/render/touching_depth.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

// The edge of an alpha test comes from a texture, not a triangle, and foliage has one in every
// pixel. On the reference tree, settled, 3 samples an axis gain 1.1 dB over 2, and 4 no more than
// 3.
constexpr int kAlphaTestSupersample = 3;
constexpr std::uint32_t kLargestFineTile = 1024;  // a larger tile would need a target of 300 MB

// Width of points and lines, texels: one pixel of the frame. Clients ask for 1.5 to 2.1 texels a
// pixel (need_for_view); this is the middle.
constexpr float kStroke = 1.78f;

// Draw buffers of a target that has ranges of blended depths besides its colour.
constexpr GLenum kColorOnly[] = {GL_COLOR_ATTACHMENT0};
constexpr GLenum kRangeOnly[] = {GL_NONE, GL_COLOR_ATTACHMENT1};
constexpr GLenum kColorAndRange[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};

}  // namespace

glm::mat4 capture_projection(const Capture& capture) {
  // Near and far planes touch the bounding sphere, so the depth buffer holds the tile's depth code.
  const double n = capture.distance - capture.radius, f = capture.distance + capture.radius;
  const double half = capture.half_tangent * n;
  const glm::dmat4 clip_from_view = glm::frustum(-half, half, -half, half, n, f);
  const CaptureBasis& b = capture.basis;
  const glm::dmat4 view_from_relative =
      glm::transpose(glm::dmat4(glm::dmat3(b.right, b.up, -b.forward)));
  return glm::mat4(clip_scale(capture.distance) * clip_from_view * view_from_relative);
}

TilePageRenderer::TilePageRenderer(const GpuScene& scene, int supersample)
    : scene_(&scene), supersample_(supersample) {}
TilePageRenderer::TilePageRenderer(TilePageRenderer&& other) noexcept = default;
TilePageRenderer& TilePageRenderer::operator=(TilePageRenderer&& other) noexcept = default;
TilePageRenderer::~TilePageRenderer() = default;

Result<TilePageRenderer> TilePageRenderer::create(const GpuScene& scene, int supersample,
                                                  SceneShadow* shadow, const TileExtras& extras) {
  TilePageRenderer out(scene, supersample);
  out.shadow_map_ = shadow;
  out.extras_ = extras;
  const bool blends = scene.prepared->blends();
  const auto compile = [&](const char* kind, Resolve& into) -> Result<void> {
    for (const bool fine : {false, true}) {
      std::vector<std::string> defines = {"FACTOR " +
                                          std::to_string(fine ? out.fine_samples() : supersample)};
      if (*kind) defines.emplace_back(kind);
      if (&into == &out.lit_.resolve && blends) defines.emplace_back("BLENDED");
      if (extras.fine_depth) defines.emplace_back("FINE_DEPTH");
      Result<gl::Program> made =
          gl::Program::create("common/fullscreen.vert", "tile/resolve_tile.frag", defines);
      if (!made) return made.error();
      (fine ? into.fine : into.usual) = made.take();
    }
    return {};
  };
  const std::pair<const char*, Resolve*> kinds[] = {{"", &out.lit_.resolve},
                                                    {"RELIT", &out.relit_.resolve},
                                                    {"SHADOW", &out.shadow_.resolve},
                                                    {"CASTER", &out.caster_}};
  for (const auto& [kind, into] : kinds) {
    if (const Result<void> compiled = compile(kind, *into); !compiled) return compiled.error();
  }
  const auto& objects = scene.prepared->objects;
  const bool layers = std::any_of(objects.begin(), objects.end(), [](const auto& object) {
    return layered(object.needs) && !object.group;
  });
  if (layers) {
    out.layers_ = std::make_unique<TileLayers>();
    out.layers_->meshes().set_probe(scene.probe_map());
    out.layers_->meshes().set_surroundings(scene.prepared->scene.environment);
  }
  const std::vector<Touching>& touching = scene.prepared->touching;
  if (std::any_of(touching.begin(), touching.end(),
                  [](const Touching& of) { return !of.others.empty(); })) {
    out.touching_ = std::make_unique<TouchingDepth>(scene);
  }
  out.lit_.meshes = std::make_unique<gl::MeshPass>(gl::MeshOutput::kColor);
  if (blends) out.lit_.ranges = std::make_unique<gl::MeshPass>(gl::MeshOutput::kRange);
  out.relit_.meshes = std::make_unique<gl::MeshPass>(gl::MeshOutput::kSurface);
  out.shadow_.meshes = std::make_unique<gl::MeshPass>(gl::MeshOutput::kShadow);
  for (const Path* path : {&out.lit_, &out.relit_, &out.shadow_}) {
    path->meshes->set_probe(scene.probe_map());
    path->meshes->set_surroundings(scene.prepared->scene.environment);
  }
  out.empty_vao_ = gl::VertexArray::create();
  if (extras.forced) {
    for (const Path* path : {&out.lit_, &out.relit_}) path->meshes->force(extras.forced);
  }
  return out;
}

std::vector<std::string> TilePageRenderer::variants() const {
  std::vector<std::string> out = lit_.meshes->variants();
  for (const std::string& name : relit_.meshes->variants()) out.push_back("relit: " + name);
  return out;
}

TilePageRenderer::Path& TilePageRenderer::path_of(const TileJob& job) {
  if (job.key.channels == kShadowTile) return shadow_;
  return job.key.channels == kRelitTile ? relit_ : lit_;
}

bool TilePageRenderer::blended(const TileJob& job) const {
  return lit_.ranges && job.key.channels == kLitTile &&
         (scene_->prepared->description(job.key.object)->needs & kNeedBlend);
}

bool TilePageRenderer::writes_surface(const std::vector<TileJob>& jobs) const {
  return std::any_of(jobs.begin(), jobs.end(), [this](const TileJob& job) {
    return job.key.channels == kRelitTile || job.key.channels == kLayeredTile || blended(job);
  });
}

bool TilePageRenderer::fine(const TileJob& job) const {
  const bool tested = scene_->prepared->description(job.key.object)->needs & kNeedAlphaMask;
  return tested && tile_edge(job.key.size_class) <= kLargestFineTile;
}

int TilePageRenderer::fine_samples() const { return std::max(supersample_, kAlphaTestSupersample); }

int TilePageRenderer::samples(const TileJob& job) const {
  return fine(job) ? fine_samples() : supersample_;
}

std::vector<GLenum> TilePageRenderer::page_formats(const Path& path) const {
  const GLenum kept = extras_.float_color ? GL_RGBA32F : GL_SRGB8_ALPHA8;
  std::vector<GLenum> page = {kept, GLenum(extras_.fine_depth ? GL_RGBA8 : GL_R8)};
  const bool behind = &path == &lit_ && (path.ranges || layers_);
  if (&path == &relit_ || behind) page.push_back(GL_RGBA8);
  return page;
}

bool TilePageRenderer::prepare_drawn(Path& path, int big, int page_edge) {
  if (path.supersampled.ok() && path.supersampled.width() >= big) return true;
  const GLenum color =
      extras_.float_color ? GL_RGBA32F : gl::color_format(scene_->prepared->blends());
  std::vector<GLenum> drawn = {color};
  if (&path == &relit_) drawn.insert(drawn.end(), {GL_RGBA16F, GL_RGBA8});
  if (path.ranges) drawn.push_back(GL_RG32F);
  if (&path == &shadow_) drawn = {GL_RGBA16F, GL_RGBA16F};
  return remake(path.supersampled, big, drawn, GL_DEPTH_COMPONENT32F, page_edge);
}

bool TilePageRenderer::prepare_targets(Path& path, int page_edge, int big) {
  if (!prepare_drawn(path, big, page_edge)) return false;
  if (&path == &shadow_ || (path.page.ok() && path.page.width() == page_edge)) return true;
  return remake(path.page, page_edge, page_formats(path), 0, page_edge);
}

bool TilePageRenderer::prepare_layers(int big, int page_edge) {
  for (const int samples : {supersample_, fine_samples()}) {
    if (!layers_->compile(samples)) return false;
  }
  gl::RenderTarget &peeled = layers_->peeled(), &floor = layers_->floor();
  const GLenum color = gl::color_format(scene_->prepared->blends());
  if ((!peeled.ok() || peeled.width() < big) &&
      !remake(peeled, big, {color}, GL_DEPTH_COMPONENT32F, page_edge)) {
    return false;
  }
  // The floor has one texel for each texel of the tile.
  return (floor.ok() && floor.width() >= big / supersample_) ||
         remake(floor, big / supersample_, {GL_R32F}, 0, page_edge);
}

bool TilePageRenderer::prepare_touching(int big, int page_edge) {
  gl::RenderTarget& own = touching_->own();
  return (own.ok() && own.width() >= big) || remake(own, big, {}, GL_DEPTH_COMPONENT32F, page_edge);
}

bool TilePageRenderer::remake(gl::RenderTarget& target, int edge, const std::vector<GLenum>& colors,
                              GLenum depth, int page_edge) const {
  const std::size_t others = gpu_bytes() - target.gpu_bytes();
  const std::size_t on_their_way =
      ring_ * readback_bytes(page_edge, page_edge, true);  // worst case: all with a surface
  if (others + on_their_way + gl::target_bytes(edge, edge, colors, depth) > most_bytes_) {
    return false;
  }
  target = gl::RenderTarget();  // frees the old one first: never both in memory
  target = gl::RenderTarget(edge, edge, colors, depth);
  return target.ok();
}

std::size_t TilePageRenderer::gpu_bytes() const {
  std::size_t bytes = 0;
  if (touching_) bytes += touching_->gpu_bytes();
  if (layers_) bytes += layers_->gpu_bytes();
  for (const Path* path : {&lit_, &relit_, &shadow_}) {
    bytes += path->supersampled.gpu_bytes() + path->page.gpu_bytes();
  }
  if (slow_) bytes += slow_->page.gpu_bytes();
  return bytes;
}

Capture TilePageRenderer::capture_of(const TileJob& job) const {
  return Capture(job.key.cell, job.key.distance,
                 scene_->prepared->description(job.key.object)->radius,
                 tile_edge(job.key.size_class));
}

TilePageRenderer::Stage TilePageRenderer::stage(const TileJob& job, const Capture& capture) const {
  Stage out;
  out.eye = glm::dvec3(scene_->prepared->description(job.key.object)->center) + capture.eye();
  out.clip_from_relative = capture_projection(capture);
  if (job.key.channels != kShadowTile) {
    out.lights = gl::light_block(job.lighting, glm::vec3(out.eye));
    return out;
  }
  out.placed = scene_->prepared->instance(job.key.instance - 1).world_from_object;
  const glm::dquat rotation(out.placed.rotation);
  const double scale = out.placed.scale;
  out.eye = out.placed.position + rotation * (scale * out.eye);
  const glm::dmat4 object_from_world(glm::mat3_cast(glm::conjugate(rotation)) / scale);
  out.clip_from_relative = out.clip_from_relative * glm::mat4(object_from_world);
  out.lights = gl::light_block(job.world, out.eye);
  return out;
}

const gl::GpuMesh& TilePageRenderer::mesh_of(const TileJob& job, const Capture& capture) const {
  const ObjectDescription& object = scene_->prepared->objects[job.key.object];
  const double clip_time = phase_time(static_cast<Phase>(job.key.phase), object.motion.clip_s);
  return object.motion.moving() ? scene_->posed_mesh(job.key.object, clip_time)
                                : scene_->mesh_for_tile(job.key.object, capture);
}

double TilePageRenderer::triangles(const TileJob& job) const {
  const Capture capture = capture_of(job);
  const InstanceGroup* const group = scene_->prepared->group(job.key.object);
  if (!group) return mesh_of(job, capture).triangles();
  double all = 0;
  for (const GroupBatch& batch : group_batches(*group, capture, group->bounds.center)) {
    all += batch.mesh->triangles() * static_cast<double>(batch.members.size());
  }
  return all;
}

void TilePageRenderer::draw_tile(const TileJob& job, const RowBand& rows) {
  const Capture capture = capture_of(job);
  const int edge = static_cast<int>(capture.edge) * samples(job);
  const Stage at = stage(job, capture);
  Path& path = path_of(job);
  if (&path == &shadow_) path.meshes->set_shadow(shadow_map_->map_for(job.world), at.eye);
  path.supersampled.bind();
  glViewport(0, 0, edge, edge);
  glScissor(0, static_cast<int>(rows.low) * samples(job), edge,
            static_cast<int>(rows.rows()) * samples(job));
  glEnable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (path.ranges) glDrawBuffers(1, kColorOnly);
  const InstanceGroup* const group = scene_->prepared->group(job.key.object);
  if (group) draw_ground(job, at, capture);
  path.meshes->set_stroke(kStroke * static_cast<float>(samples(job)));
  path.meshes->begin(at.clip_from_relative, at.lights);
  if (group) {
    const bool world = &path == &shadow_;
    const glm::dvec3 eye = world ? at.eye : group->bounds.center + at.eye;
    for (const GroupBatch& batch : group_batches(*group, capture, eye)) {
      path.meshes->draw(*batch.mesh, scene_->materials(), scene_->images, batch.members.data(),
                        batch.members.size(), false);
    }
  } else {
    const gl::MeshInstance instance = gl::mesh_instance(at.placed, at.eye, 0);
    const gl::GpuMesh& mesh = mesh_of(job, capture);
    for (const bool second : {false, true}) {
      path.meshes->draw(mesh, scene_->materials(), scene_->images, &instance, 1, second);
    }
    if (blended(job)) draw_ranges(job, at, mesh, instance);
    if (job.key.channels == kLayeredTile) draw_behind(job, rows, at, mesh, instance);
  }
  path.meshes->end();
  keep_clear(job, rows, at, capture);
  if (path.ranges) glDrawBuffers(2, kColorAndRange);
}

void TilePageRenderer::draw_ground(const TileJob& job, const Stage& at, const Capture& capture) {
  const std::vector<std::uint32_t>& ground = scene_->prepared->touching[job.key.object].others;
  if (!touching_ || job.key.channels == kShadowTile || ground.empty()) return;
  TouchingDepth::View view{capture, at.clip_from_relative, at.eye, {}};
  view.eye += scene_->prepared->group(job.key.object)->bounds.center;
  touching_->draw_ground(view, ground);
}

void TilePageRenderer::draw_behind(const TileJob& job, const RowBand& rows, const Stage& at,
                                   const gl::GpuMesh& mesh, const gl::MeshInstance& instance) {
  layers_->begin(lit_.supersampled, static_cast<int>(tile_edge(job.key.size_class)), rows,
                 samples(job));
  gl::MeshPass& meshes = layers_->meshes();
  meshes.set_stroke(kStroke * static_cast<float>(samples(job)));
  meshes.begin(at.clip_from_relative, at.lights);
  meshes.draw(mesh, scene_->materials(), scene_->images, &instance, 1, false);
  meshes.end();
  lit_.supersampled.bind();
}

const Touching* TilePageRenderer::touching(const TileJob& job) const {
  const bool stores_depth = job.key.channels == kLitTile || job.key.channels == kRelitTile;
  if (!touching_ || !stores_depth) return nullptr;
  const PreparedScene& scene = *scene_->prepared;
  const InstanceGroup* const group = scene.group(job.key.object);
  if (group && group->part == kNoGroup) return nullptr;
  const Touching& found =
      scene.touching[group ? scene.scene.instances[group->first_leaf].object : job.key.object];
  return found.others.empty() ? nullptr : &found;
}

void TilePageRenderer::keep_clear(const TileJob& job, const RowBand& rows, const Stage& at,
                                  const Capture& capture) {
  const Touching* const found = touching(job);
  if (!found) return;
  TouchingDepth::View view{capture, at.clip_from_relative, at.eye, {}};
  if (const InstanceGroup* const part = scene_->prepared->group(job.key.object)) {
    view.eye += part->bounds.center;
  } else {
    view.world_from_space = scene_->prepared->instance(found->instance).world_from_object;
  }
  const auto n = static_cast<std::uint32_t>(samples(job));
  touching_->push(path_of(job).supersampled, static_cast<int>(capture.edge * n),
                  {rows.low * n, rows.high * n}, view, found->others);
}

void TilePageRenderer::draw_ranges(const TileJob& job, const Stage& at, const gl::GpuMesh& mesh,
                                   const gl::MeshInstance& instance) {
  glDrawBuffers(2, kRangeOnly);
  gl::MeshPass& ranges = *lit_.ranges;
  ranges.set_stroke(kStroke * static_cast<float>(samples(job)));
  ranges.begin(at.clip_from_relative, at.lights);
  ranges.draw(mesh, scene_->materials(), scene_->images, &instance, 1, true);
  ranges.end();
}

std::vector<TilePageRenderer::GroupBatch> TilePageRenderer::group_batches(
    const InstanceGroup& group, const Capture& capture, const glm::dvec3& eye) const {
  const std::vector<Instance>& instances = scene_->prepared->scene.instances;
  std::vector<GroupBatch> batches;  // in the order of the instances, so that it never varies
  for (std::uint32_t i = group.first_leaf; i < group.first_leaf + group.leaves; ++i) {
    const Similarity& m = instances[i].world_from_object;
    const gl::GpuMesh* mesh = group.part != kNoGroup
                                  ? &scene_->part(group.part)
                                  : &scene_->mesh_for_group(instances[i].object, m.scale, capture);
    auto at = std::find_if(batches.begin(), batches.end(),
                           [&](const GroupBatch& batch) { return batch.mesh == mesh; });
    if (at == batches.end()) at = batches.insert(batches.end(), GroupBatch{mesh, {}});
    at->members.push_back(gl::mesh_instance(m, eye, i));
  }
  return batches;
}

void TilePageRenderer::resolve(const TileJob& job, const gl::RenderTarget& page,
                               PagePacker::Place place) {
  const int edge = static_cast<int>(tile_edge(job.key.size_class));
  Path& path = path_of(job);
  Resolve& resolve = job.key.channels == kCasterTile ? caster_ : path.resolve;
  gl::Program& program = fine(job) ? resolve.fine : resolve.usual;
  page.bind();
  glViewport(place.x, place.y, edge, edge);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  if (job.key.channels == kLayeredTile) {
    return layers_->resolve(path.supersampled, place.x, place.y, samples(job));
  }
  program.use();
  program.set("u_color", 0);
  program.set("u_depth", 1);
  program.set("u_origin", glm::ivec2(place.x, place.y));
  std::vector<GLuint> inputs = {path.supersampled.color(0), path.supersampled.depth()};
  if (&path == &relit_) {
    const CaptureBasis basis = capture_of(job).basis;
    program.set("u_normal", 2);
    program.set("u_material", 3);
    program.set("u_right", glm::vec3(basis.right));
    program.set("u_up", glm::vec3(basis.up));
    inputs.insert(inputs.end(), {path.supersampled.color(1), path.supersampled.color(2)});
  } else if (path.ranges && job.key.channels == kLitTile) {
    program.set("u_range", 2);
    inputs.push_back(path.supersampled.color(1));
  } else if (&path == &shadow_) {
    program.set("u_darkened", 2);
    inputs.push_back(path.supersampled.color(1));
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
  const auto largest = [&](const Path& path) {  // largest edge in samples; 0: no tile of this kind
    int edge = 0;
    for (const TileJob& job : jobs) {
      if (&path_of(job) != &path) continue;
      edge = std::max(edge, static_cast<int>(tile_edge(job.key.size_class)) * samples(job));
    }
    return edge;
  };
  int behind = 0, clear = 0;  // the same for layered tiles, and for those that keep clear
  for (const TileJob& job : jobs) {
    const int big = static_cast<int>(tile_edge(job.key.size_class)) * samples(job);
    if (job.key.channels == kLayeredTile) behind = std::max(behind, big);
    if (touching(job)) clear = std::max(clear, big);
  }
  const int edge = packer.page_edge(), relit = largest(relit_), darkened = largest(shadow_);
  // Shadow tiles have no page of their own, so the lit page is needed.
  const int lit = relit > 0 ? largest(lit_) : std::max(largest(lit_), 1);
  if (lit > 0 && !prepare_targets(lit_, edge, lit)) return nullptr;
  if (behind > 0 && !prepare_layers(behind, edge)) return nullptr;
  if (clear > 0 && !prepare_touching(clear, edge)) return nullptr;
  if (relit > 0 && !prepare_targets(relit_, edge, relit)) return nullptr;
  if (darkened > 0 && !prepare_targets(shadow_, edge, darkened)) return nullptr;
  const gl::RenderTarget& page = relit > 0 ? relit_.page : lit_.page;
  glEnable(GL_FRAMEBUFFER_SRGB);
  glEnable(GL_DEPTH_CLAMP);
  // Tiles of the same object and light are drawn together: fewer state changes.
  std::vector<std::size_t> order(jobs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const TileKey &ka = jobs[a].key, &kb = jobs[b].key;
    const bool da = ka.channels == kShadowTile, db = kb.channels == kShadowTile;
    if (da != db) return db;
    // each lighting has its own shadow map
    if (da && ka.lighting != kb.lighting) return ka.lighting < kb.lighting;
    return std::tie(ka.object, ka.phase, ka.lighting, a) <
           std::tie(kb.object, kb.phase, kb.lighting, b);
  });
  for (const std::size_t i : order) {
    draw_tile(jobs[i], {0, tile_edge(jobs[i].key.size_class)});
    resolve(jobs[i], page, packer.places()[i]);
  }
  return &page;
}

}  // namespace mirage

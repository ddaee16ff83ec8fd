#include "server/render/reference_renderer.h"

#include <algorithm>
#include <chrono>
#include <tuple>

#include "protocol/impostor/motion.h"
#include "protocol/impostor/object_proxy.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/scene_shadow.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

const std::vector<GLenum> kKeptFormats = {GL_SRGB8_ALPHA8, GL_R32F, GL_R32UI};

// Of views, so that no scene makes them take too long: what is smaller in radius is left out, and
// what comes after the largest.
constexpr double kLeastPx = 0.5;
constexpr std::ptrdiff_t kMostInstances = 20'000;

constexpr GLenum kColorOnly[] = {GL_COLOR_ATTACHMENT0, GL_NONE};
constexpr GLenum kIdOnly[] = {GL_NONE, GL_COLOR_ATTACHMENT1};

glm::dvec3 center_relative(const Instance& instance, const ObjectDescription& object,
                           const glm::dvec3& eye) {
  const Similarity& m = instance.world_from_object;
  const glm::dvec3 offset = glm::dquat(m.rotation) * (glm::dvec3(object.center) * double{m.scale});
  return m.position - eye + offset;
}

/// Rows bottom up -> top down.
template <typename T>
void flip(std::vector<T>& pixels, std::size_t row) {
  for (std::size_t low = 0, high = pixels.size(); low + row < high; low += row) {
    high -= row;
    std::swap_ranges(pixels.begin() + static_cast<std::ptrdiff_t>(low),
                     pixels.begin() + static_cast<std::ptrdiff_t>(low + row),
                     pixels.begin() + static_cast<std::ptrdiff_t>(high));
  }
}

template <typename T>
void append(Bytes& out, const std::vector<T>& plane) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(plane.data());
  out.insert(out.end(), bytes, bytes + plane.size() * sizeof(T));
}

// What the framebuffer that is bound holds, rows from the top.
SceneFrame read_back(int w, int h) {
  const std::size_t row = static_cast<std::size_t>(w);
  const std::size_t pixels = row * static_cast<std::size_t>(h);
  SceneFrame frame;
  frame.rgba.resize(pixels * 4);
  frame.depth.resize(pixels);
  frame.ids.resize(pixels);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, w, h, GL_RGBA, GL_UNSIGNED_BYTE, frame.rgba.data());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, w, h, GL_RED, GL_FLOAT, frame.depth.data());
  glReadBuffer(GL_COLOR_ATTACHMENT2);
  glReadPixels(0, 0, w, h, GL_RED_INTEGER, GL_UNSIGNED_INT, frame.ids.data());
  flip(frame.rgba, row * 4);
  flip(frame.depth, row);
  flip(frame.ids, row);
  return frame;
}

}  // namespace

ReferenceRenderer::ReferenceRenderer(const GpuScene& scene)
    : scene_(&scene),
      meshes_(std::make_unique<gl::MeshPass>(gl::MeshOutput::kId)),
      fronts_(std::make_unique<gl::MeshPass>(gl::MeshOutput::kFront)) {}

Result<ReferenceRenderer> ReferenceRenderer::create(const GpuScene& scene, SceneShadow* shadow) {
  ReferenceRenderer out(scene);
  out.shadow_ = shadow;
  out.meshes_->set_probe(scene.probe_map());
  out.meshes_->set_backdrop(scene.prepared->scene.environment.horizon);
  Result<gl::SkyPass> sky = gl::SkyPass::create();
  if (!sky) return sky.error();
  out.sky_ = std::move(*sky);
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

std::size_t ReferenceRenderer::level_of(const SceneShot& shot, const Instance& instance,
                                        double distance) const {
  const ObjectDescription& object = scene_->prepared->objects[instance.object];
  if (shot.level_px <= 0 || object.lods.empty() || object.motion.moving()) return 0;
  const double nearest = std::max(distance, shot.camera.near_m);
  const double px_per_unit = shot.camera.focal_px() * instance.world_from_object.scale / nearest;
  return lod_for_view(object.lods, px_per_unit, shot.level_px);
}

std::vector<ReferenceRenderer::Visible> ReferenceRenderer::visible(const SceneShot& shot) const {
  const PreparedScene& prepared = *scene_->prepared;
  const Frustum frustum(shot.camera);
  std::vector<Visible> out;
  for (std::uint32_t i = 0; i < prepared.scene.instances.size(); ++i) {
    const Instance& instance = prepared.scene.instances[i];
    const ObjectDescription& object = prepared.objects[instance.object];
    const double radius = double{object.radius} * instance.world_from_object.scale;
    const glm::dvec3 offset = center_relative(instance, object, shot.camera.pose.eye);
    if (!frustum.may_see(offset, radius)) continue;
    const double distance = glm::length(offset) - radius;
    const double size_px = shot.camera.focal_px() * radius / std::max(distance, 1e-9);
    if (shot.level_px > 0 && size_px < kLeastPx) continue;
    out.push_back({instance.object, level_of(shot, instance, distance), i, size_px});
  }
  if (shot.level_px > 0 && out.size() > std::size_t{kMostInstances}) {
    std::nth_element(out.begin(), out.begin() + kMostInstances, out.end(),
                     [](const Visible& a, const Visible& b) { return a.size_px > b.size_px; });
    out.resize(kMostInstances);
  }
  std::sort(out.begin(), out.end(), [](const Visible& a, const Visible& b) {
    return std::tie(a.object, a.level, a.instance) < std::tie(b.object, b.level, b.instance);
  });
  return out;
}

void ReferenceRenderer::draw_scene(const SceneShot& shot, DepthMapping mapping) {
  const Camera& camera = shot.camera;
  const glm::dvec3& eye = camera.pose.eye;
  const gl::LightBlock lights = gl::light_block(shot.lighting, eye);
  meshes_->begin(camera.clip_from_relative(mapping), lights, mapping);
  const Environment& environment = scene_->prepared->scene.environment;
  meshes_->set_fog(environment.horizon, environment.fog_density);
  const std::vector<Visible> all = visible(shot);
  std::vector<gl::MeshInstance> run;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [object, level, instance, size_px] = all[i];
    run.push_back(gl::mesh_instance(scene_->prepared->scene.instances[instance].world_from_object,
                                    eye, instance));
    if (scene_->prepared->objects[object].motion.moving()) {
      draw_moving(*meshes_, run.back(), false);
      run.clear();
      continue;
    }
    const bool last =
        i + 1 == all.size() || all[i + 1].object != object || all[i + 1].level != level;
    if (!last) continue;
    meshes_->draw(scene_->level(object, level), scene_->materials(), scene_->images, run.data(),
                  run.size(), false);
    run.clear();
  }
  const std::vector<std::uint32_t> blended = blended_instances(camera);
  glDrawBuffers(2, kColorOnly);
  for (const std::uint32_t i : blended) draw_blended(*meshes_, camera, i);
  meshes_->end();
  // Depth and id are of what is nearest, blended or not: the last to be written.
  glDrawBuffers(2, kIdOnly);
  fronts_->begin(camera.clip_from_relative(mapping), lights, mapping);
  for (const std::uint32_t i : blended) draw_blended(*fronts_, camera, i);
  fronts_->end();
}

std::vector<std::uint32_t> ReferenceRenderer::blended_instances(const Camera& camera) const {
  const PreparedScene& prepared = *scene_->prepared;
  std::vector<std::pair<double, std::uint32_t>> blended;
  for (std::uint32_t i = 0; i < prepared.scene.instances.size(); ++i) {
    const Instance& instance = prepared.scene.instances[i];
    const ObjectDescription& object = prepared.objects[instance.object];
    if (!(object.needs & kNeedBlend)) continue;
    const glm::dvec3 center = center_relative(instance, object, camera.pose.eye);
    blended.emplace_back(-glm::length(center), i);  // farthest first
  }
  std::sort(blended.begin(), blended.end());
  std::vector<std::uint32_t> out;
  for (const auto& [order, i] : blended) out.push_back(i);
  return out;
}

void ReferenceRenderer::draw_blended(gl::MeshPass& pass, const Camera& camera, std::uint32_t i) {
  const Instance& instance = scene_->prepared->scene.instances[i];
  draw_moving(pass, gl::mesh_instance(instance.world_from_object, camera.pose.eye, i), true);
}

void ReferenceRenderer::draw_moving(gl::MeshPass& pass, const gl::MeshInstance& one, bool blended) {
  const Instance& instance = scene_->prepared->scene.instances[one.id];
  const MotionProfile& motion = scene_->prepared->objects[instance.object].motion;
  const double time = wrap_clip(time_s_ + double{instance.clip_offset_s}, motion.clip_s);
  pass.draw(scene_->posed_mesh(instance.object, time), scene_->materials(), scene_->images, &one, 1,
            blended);
}

std::vector<GLenum> ReferenceRenderer::drawn_formats() const {
  return {gl::color_format(scene_->prepared->blends()), GL_R32UI};
}

std::size_t ReferenceRenderer::gpu_bytes(const SceneShot& job) const {
  const int w = static_cast<int>(job.camera.width), h = static_cast<int>(job.camera.height);
  const int s = static_cast<int>(job.supersample);
  return gl::target_bytes(w * s, h * s, drawn_formats(), GL_DEPTH_COMPONENT32F) +
         gl::target_bytes(w, h, kKeptFormats, 0);
}

Result<SceneFrame> ReferenceRenderer::draw(const SceneShot& job) {
  meshes_->set_shadow(shadow_ ? shadow_->map_for(job.lighting) : nullptr, job.camera.pose.eye);
  const int w = static_cast<int>(job.camera.width), h = static_cast<int>(job.camera.height);
  const int s = static_cast<int>(job.supersample);
  gl::RenderTarget big(w * s, h * s, drawn_formats(), GL_DEPTH_COMPONENT32F);
  gl::RenderTarget out(w, h, kKeptFormats, 0);
  if (!big.ok() || !out.ok()) {
    return make_error(ErrorId::kGraphicsGl, "reference frame is too large for this device");
  }
  glEnable(GL_FRAMEBUFFER_SRGB);
  glDisable(GL_DEPTH_CLAMP);
  glDisable(GL_SCISSOR_TEST);
  big.bind();
  const GLuint no_id[4] = {0, 0, 0, 0};
  const gl::ViewDepth view_depth;
  const float far_depth = view_depth.farthest();
  glClearBufferuiv(GL_COLOR, 1, no_id);
  glDepthMask(GL_TRUE);
  glClearBufferfv(GL_DEPTH, 0, &far_depth);
  glDrawBuffers(2, kColorOnly);
  sky_.draw(job.camera, scene_->prepared->scene.environment);
  const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, both);
  time_s_ = job.time_s;
  meshes_->set_stroke(static_cast<float>(s));
  draw_scene(job, view_depth.mapping());

  out.bind();
  glDisable(GL_DEPTH_TEST);
  resolve_.use();
  const GLuint inputs[3] = {big.color(0), big.depth(), big.color(1)};
  for (int i = 0; i < 3; ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    glBindTexture(GL_TEXTURE_2D, inputs[i]);
  }
  resolve_.set("u_color", 0);
  resolve_.set("u_depth", 1);
  resolve_.set("u_id", 2);
  resolve_.set("u_factor", s);
  resolve_.set("u_window_depth", glm::vec2(job.camera.window_depth(view_depth.mapping())));
  resolve_.set("u_farthest", view_depth.farthest());
  glBindVertexArray(empty_vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);

  return read_back(w, h);
}

Result<Bytes> ReferenceRenderer::render(const ReferenceJob& job) {
  const auto start = std::chrono::steady_clock::now();
  const Result<SceneFrame> frame = draw(job.shot);
  if (!frame) return frame.error();
  Bytes raw;
  raw.reserve(frame->depth.size() * 12);
  append(raw, frame->rgba);
  append(raw, frame->depth);
  append(raw, frame->ids);

  wire::ReferenceReplyT reply;
  reply.request_id = job.request_id;
  reply.width = job.shot.camera.width;
  reply.height = job.shot.camera.height;
  reply.raw_bytes = static_cast<std::uint32_t>(raw.size());
  reply.render_us =
      static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(
                                     std::chrono::steady_clock::now() - start)
                                     .count());
  return encode_message(std::move(reply), compress_block(raw.data(), raw.size()));
}

}  // namespace mirage

#include "tests/gl/bench.h"

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "client/frame/planned_frame.h"
#include "client/hold/tile_cache.h"
#include "client/plan/tile_need.h"
#include "client/scene/scene_view.h"
#include "client/session/shadow_stage.h"
#include "protocol/base/stable_math.h"
#include "protocol/codec/atlas_planes.h"
#include "protocol/codec/image_codec.h"
#include "protocol/codec/model_codec.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/capture.h"
#include "protocol/impostor/error_bound.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/model/scene_types.h"
#include "protocol/wire/conversions.h"
#include "server/prepare/derived_cache.h"
#include "server/prepare/object_description.h"
#include "server/prepare/object_geometry.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "server/render/readback_ring.h"
#include "server/scene/environment/builtin_environment.h"
#include "server/scene/environment/probe_filter.h"
#include "server/scene/gltf/bounds.h"
#include "server/session/session.h"
#include "server/tile/tile_encode.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/render_target.h"

namespace mirage::test {
namespace {

constexpr int kAtlasEdge = 2048;
constexpr int kAtlasLayers = 2;

// Returns the light of the protocol. three.js divides both kinds by pi (BRDF_Lambert). Here a
// light's colour is irradiance per pi already, and ambient the radiance of a white surface: 0.6 and
// 2.5 become 0.191 and 0.796.
Lighting field_light(BenchLight kind) {
  Lighting lighting;
  constexpr float kPi = 3.14159265f;
  lighting.ambient = glm::vec3(kind == BenchLight::kLit ? 0.6f / kPi : 1.0f);
  if (kind == BenchLight::kAlbedo) return lighting;
  if (kind == BenchLight::kProbe) {
    lighting.ambient = glm::vec3(0);
    lighting.probe.rotation = glm::angleAxis(0.7f, glm::normalize(glm::vec3(0.2f, 1, -0.3f)));
    lighting.probe.strength = 0.8f;
    return lighting;
  }
  Light sun;
  sun.color = glm::vec3(2.5f / kPi);
  sun.direction = -glm::normalize(glm::vec3(2, 3, 1));
  lighting.lights = {sun};
  return lighting;
}

// Returns the whole model as one object. Its transparent materials, unless they are kept, are
// alpha-tested: the field's protocol calls this the alpha-tested tree.
PreparedScene as_one_object(const PreparedScene& prepared, const Similarity& placed,
                            BenchBlending blending) {
  const Scene& from = prepared.scene;
  Scene scene;
  scene.materials = from.materials;
  for (Material& m : scene.materials) {
    const bool blends = m.alpha_mode == AlphaMode::kBlend;
    if (blends && blending == BenchBlending::kTested) m.alpha_mode = AlphaMode::kMask;
  }
  scene.images = from.images;
  SceneObject whole;
  for (const Instance& instance : from.instances) {
    const Similarity& t = instance.world_from_object;
    const Mesh& mesh = from.objects[instance.object].mesh;
    const auto vertex = static_cast<std::uint32_t>(whole.mesh.vertices.size());
    const auto index = static_cast<std::uint32_t>(whole.mesh.indices.size());
    for (Vertex v : mesh.vertices) {
      v.position = glm::vec3(t.position) + t.rotation * (t.scale * v.position);
      v.normal = t.rotation * v.normal;
      v.tangent = glm::vec4(t.rotation * glm::vec3(v.tangent), v.tangent.w);
      whole.mesh.vertices.push_back(v);
    }
    for (const std::uint32_t i : mesh.indices) whole.mesh.indices.push_back(vertex + i);
    for (Primitive p : mesh.primitives) {
      p.first_index += index;
      whole.mesh.primitives.push_back(p);
    }
  }
  scene.objects = {whole};
  scene.instances = {Instance{0, placed}};
  PreparedScene out;
  out.objects = {describe_object(whole, scene)};
  out.geometry = {make_geometry(scene, whole, out.objects[0])};
  out.grouping = no_groups(1);
  for (const Image& image : scene.images) {
    ImageDescription d;
    d.width = image.width;
    d.height = image.height;
    d.srgb = image.srgb;
    const auto index = static_cast<std::int32_t>(out.images.size());
    d.alpha_cutoff = alpha_test_cutoff(index, scene.materials);
    out.images.push_back(d);
  }
  out.mips = make_mips(scene);
  out.scene = std::move(scene);
  out.bounds_center =
      placed.position + glm::dvec3(placed.rotation * out.objects[0].center) * double{placed.scale};
  out.bounds_radius = out.objects[0].radius * placed.scale;
  return out;
}

}  // namespace

glm::dvec3 fibonacci_direction(int i, int count) {
  const double s = std::sin(5.0 * 0.017453292519943295);
  const double y = s + (1.0 - s) * (i + 0.5) / count;
  const double azimuth = 2.399963 * i, ring = std::sqrt(1.0 - y * y);
  return {ring * std::cos(azimuth), y, ring * std::sin(azimuth)};
}

glm::dvec3 turned(const glm::dvec3& direction, double degrees, double bearing) {
  const glm::dvec3 any = std::abs(direction.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 a = glm::normalize(glm::cross(any, direction));
  const glm::dvec3 b = glm::cross(direction, a);
  const double angle = degrees * 0.017453292519943295;
  return std::cos(angle) * direction +
         std::sin(angle) * (std::cos(bearing) * a + std::sin(bearing) * b);
}

std::optional<SceneView> scene_as_told(const std::shared_ptr<const PreparedScene>& prepared) {
  const SteadyClock clock;
  StageQueues queues(clock, 1 << 20, {});
  SessionHub hub(prepared, {}, queues);
  const SessionId id = hub.open();
  wire::HelloT hello;
  hello.version_min = hello.version_max = limits::kProtocolVersion;
  hello.codecs = {0, 1};
  const Bytes greeting = encode_message(std::move(hello));
  if (!hub.receive(id, greeting.data(), greeting.size())) return std::nullopt;
  SceneView scene;
  PacketAssembler assembler(limits::kMaxTransferBytes);
  while (const PacketPtr packet = hub.next_packet(id)) {
    const auto whole = assembler.accept(packet->data(), packet->size());
    if (!whole || !whole->has_value()) continue;
    Message m = decode_message((*whole)->data(), (*whole)->size()).take();
    bool taken = true;
    if (m.body.AsWelcome()) taken = scene.accept(*m.body.AsWelcome()).ok();
    if (m.body.AsLightProbePage()) {
      taken = scene.accept(*m.body.AsLightProbePage(), m.payload).ok();
    }
    if (m.body.AsImagePage()) taken = scene.accept(*m.body.AsImagePage()).ok();
    if (m.body.AsObjectPage()) taken = scene.accept(*m.body.AsObjectPage()).ok();
    if (m.body.AsInstancePage()) taken = scene.accept(*m.body.AsInstancePage()).ok();
    if (!taken) return std::nullopt;
  }
  if (!scene.complete()) return std::nullopt;
  return scene;
}

std::unique_ptr<Bench> Bench::create(const std::string& spec, BenchLight light,
                                     const Similarity& placed, float fog_density,
                                     BenchBlending blending) {
  auto bench = std::make_unique<Bench>();
  const auto refuse = [](const Error& error) {
    std::fprintf(stderr, "%s\n", error.line().c_str());
    return nullptr;
  };
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  if (!egl) return refuse(egl.error());
  bench->egl_ = std::move(*egl);
  Result<std::shared_ptr<const PreparedScene>> scene = load_scene(spec);
  if (!scene) return refuse(scene.error());
  auto prepared = std::make_shared<PreparedScene>(as_one_object(**scene, placed, blending));
  bench->light_ = field_light(light);
  if (light == BenchLight::kProbe) {
    auto probe = std::make_shared<const LightProbe>(make_probe(*builtin_environment("sky"), {}));
    bench->light_.probe.id = probe->id;
    prepared->scene.probe = std::move(probe);
  }
  prepared->scene.lighting = bench->light_;
  prepared->scene.environment = Environment{};  // sRGB 128
  prepared->scene.environment.fog_density = fog_density;
  bench->prepared_ = prepared;
  bench->gpu_ = std::make_unique<GpuScene>(bench->prepared_);
  bench->pages_ =
      std::make_unique<TilePageRenderer>(TilePageRenderer::create(*bench->gpu_, 2).take());
  bench->references_ =
      std::make_unique<ReferenceRenderer>(ReferenceRenderer::create(*bench->gpu_).take());
  Result<FrameRenderer> renderer = FrameRenderer::create(kAtlasEdge, kAtlasLayers, kFlatMethods);
  if (!renderer) return refuse(renderer.error());
  bench->renderer_ = std::make_unique<FrameRenderer>(renderer.take());
  bench->target_ = std::make_unique<FrameTarget>(FrameTarget::create(kSize, kSize, 4).take());
  std::optional<SceneView> told = scene_as_told(bench->prepared_);
  if (!told) {
    std::fprintf(stderr, "the scene is not told whole\n");
    return nullptr;
  }
  if (Result<void> reset = bench->renderer_->reset(*told); !reset) return refuse(reset.error());
  bench->scene_ = std::move(*told);
  return bench;
}

Camera Bench::camera(double radii, const glm::dvec3& direction) const {
  const double r = instance().radius, d = radii * r;
  Camera c;
  c.width = c.height = kSize;
  c.fov_y = 2.0 * std::atan(1.05 * r / tangent_length(d, r));
  c.pose = look_at(instance().center + direction * d, instance().center);
  c.fit_depth_range(prepared_->bounds_center, prepared_->bounds_radius);
  return c;
}

TileCache Bench::make_cache() const {
  TileCache cache(kAtlasEdge, kAtlasLayers);
  cache.reset(scene_, scene_.lighting);
  return cache;
}

TileRecordPtr Bench::tile_for(const Camera& c, TileCache& cache, std::uint8_t channels) {
  const ObjectDescription& object = scene_.objects[0];
  const ViewGeometry view = view_geometry(c, instance(), object);
  const TileNeed need = need_for_view(view, ViewPlan{});
  TileJob job;
  job.key.cell = *view_cell_from_direction(view.eye, limits::kMaxViewLevel);
  job.key.distance = *distance_bucket_from_radii(glm::length(view.eye) / view.radius, 16);
  job.key.size_class = need.size_class;
  job.key.channels = channels;
  job.lighting =
      object_lighting(light_, instance().world_from_object, object.center, object.radius);
  PagePacker packer(512);
  packer.add(tile_edge(need.size_class));
  ReadbackRing ring(1);
  PendingPage pending;
  pending.jobs = {job};
  pending.surface = pages_->writes_surface({job});
  pending.places = {{0, 0}};
  pending.width = packer.used().x;
  pending.height = packer.used().y;
  ring.start(*pages_->render({job}, packer), pending);
  const ReadbackRing::Collected page = *ring.collect(true);
  const StoredTilePtr stored =
      encode_tile({job, *page.pixels, 0, 0, 0, 0}, object, TileCodec::kZstd);
  Tile tile = tile_from_fields(stored->reply).take();
  if (!decode_tile_planes(stored->planes.data(), stored->planes.size(), TileCodec::kZstd, tile)) {
    return nullptr;
  }
  tile_bytes_ = stored->planes.size();
  tile_hash_ = stored->reply.content_hash;
  const AtlasPlanes planes = atlas_planes(tile);
  const Capture capture(job.key.cell, job.key.distance, object.radius, tile.edge);
  TileRecordPtr record = cache.insert(0, scene_, capture, std::move(tile), 1, 0);
  if (record && !renderer_->upload(*record, planes)) return nullptr;
  return record;
}

void Bench::draw(const Camera& c, const TileRecordPtr& tile, DrawMethod method) {
  DrawnImpostor drawn{0, tile, method, 0, glm::length(c.pose.eye), 1};
  DrawList list;
  list.impostors.push_back(drawn);
  renderer_->draw(*target_, {c, &scene_, list, light_});
}

std::vector<std::uint8_t> Bench::picture_of_two(const Camera& c, const TileRecordPtr& tile,
                                                double behind_radii, DrawMethod near_method,
                                                DrawMethod far_method) {
  SceneView two = scene_;
  InstanceView copy = instance();
  const glm::dvec3 behind = behind_radii * copy.radius * c.forward();
  copy.center += behind;
  copy.world_from_object.position += behind;
  two.instances.push_back(copy);
  const double distance = glm::length(instance().center - c.pose.eye);
  DrawList list;
  list.impostors.push_back({1, tile, far_method, 0, distance + behind_radii * copy.radius, 1});
  list.impostors.push_back({0, tile, near_method, 0, distance, 1});
  renderer_->draw(*target_, {c, &two, list, light_});
  return target_->read();
}

std::vector<std::uint8_t> Bench::placeholder_picture(const Camera& c) {
  DrawList list;
  list.placeholders.push_back({0, glm::length(c.pose.eye), false});
  renderer_->draw(*target_, {c, &scene_, list, light_});
  return target_->read();
}
std::vector<std::uint8_t> Bench::mesh_picture(const Camera& c, float fade) {
  const Scene& scene = prepared_->scene;
  if (!renderer_->add_mesh(0, 0, object_model(scene, scene.objects[0].mesh))) return {};
  for (std::uint32_t i = 0; i < prepared_->scene.images.size(); ++i) {
    renderer_->add_image(i, prepared_->scene.images[i], prepared_->mips[i]);
  }
  DrawList list;
  list.meshes.push_back({0, 0, fade});
  renderer_->draw(*target_, {c, &scene_, list, light_});
  return target_->read();
}

std::vector<std::uint8_t> Bench::rested_mesh_picture(const Camera& c, int drawings, double scale) {
  const FrameTarget target =
      FrameTarget::create(kSize, kSize, scale < 1 ? 0 : 4, false, scale).take();
  Refinement refinement;
  mesh_picture(c);
  DrawList list;
  list.meshes.push_back({0, 0, 1});
  renderer_->draw(target, {c, &scene_, list, light_});
  refinement.restart();
  for (int i = 0; i < drawings; ++i) {
    refinement.draw_more(*renderer_, target, {c, &scene_, list, light_});
  }
  return refinement.picture(target).read();
}

std::vector<std::uint8_t> Bench::tints(const Camera& c, const DrawList& list, const Tints& tints) {
  const gl::RenderTarget target(kSize, kSize, {GL_RGBA8}, GL_DEPTH_COMPONENT32F);
  target.bind();
  glViewport(0, 0, kSize, kSize);
  if (!renderer_->draw_tints(c, {c, &scene_, list, light_}, tints)) return {};
  constexpr std::size_t kRow = std::size_t{kSize} * 4;
  std::vector<std::uint8_t> rows(kRow * kSize), out;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer());
  glReadPixels(0, 0, kSize, kSize, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
  for (std::size_t y = kSize; y-- > 0;) {
    out.insert(out.end(), rows.begin() + static_cast<std::ptrdiff_t>(y * kRow),
               rows.begin() + static_cast<std::ptrdiff_t>((y + 1) * kRow));
  }
  return out;
}

std::vector<std::uint8_t> Bench::picture(const Camera& c, const TileRecordPtr& tile,
                                         DrawMethod method) {
  draw(c, tile, method);
  return target_->read();
}

ReferenceFrame Bench::truth_frame(const Camera& c, std::uint32_t samples) {
  SceneShot shot;
  shot.camera = c;
  shot.supersample = samples;
  shot.lighting = light_;
  SceneFrame drawn = references_->draw(shot).take();
  return {c.width, c.height, std::move(drawn.rgba), std::move(drawn.depth), std::move(drawn.ids)};
}

std::vector<std::uint8_t> Bench::truth(const Camera& c, std::uint32_t samples) {
  return truth_frame(c, samples).rgba;
}

}  // namespace mirage::test

#include "client/draw/frame_renderer.h"

#include <map>
#include <optional>
#include <utility>

#include "client/draw/caster_pass.h"
#include "client/draw/drawing.h"
#include "client/draw/frame_target.h"
#include "client/draw/impostor_pass.h"
#include "client/draw/shadow_atlas.h"
#include "client/draw/tints.h"
#include "client/draw/view_pass.h"
#include "client/frame/asset_id.h"
#include "client/frame/planned_frame.h"
#include "client/scene/scene_view.h"
#include "protocol/base/order.h"
#include "protocol/codec/model_codec.h"
#include "protocol/model/animation.h"
#include "protocol/model/model.h"
#include "protocol/model/scene_types.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/sky_pass.h"

namespace mirage {
namespace {
// The mip level of a pixel is half a level blurrier than the mean of samples that each choose their
// own level.
constexpr float kSharpenLevels = 0.75f;
constexpr float kSharpenTestedLevels = 1.5f;  // alpha tests run for every sample

// Sorts opaque meshes near to far, because near ones hide those drawn later. Blended meshes are
// sorted far to near, because they are drawn over what is behind them.
std::vector<DrawnMesh> in_drawing_order(std::vector<DrawnMesh> meshes, const Camera& camera,
                                        const SceneView& scene, bool blended) {
  const auto distance = [&](const DrawnMesh& drawn) {
    const InstanceView& view = scene.instances[drawn.instance];
    return glm::length(view.center - camera.pose.eye) - view.radius;
  };
  sort_ascending(
      meshes, [&](const DrawnMesh& drawn) { return blended ? -distance(drawn) : distance(drawn); });
  return meshes;
}
}  // namespace

struct FrameRenderer::Parts {
  struct ClientMesh {
    gl::GpuMesh mesh;
    std::vector<Material> materials;
    std::vector<Vertex> bind;  ///< bind pose of a moving object
    std::shared_ptr<const Animation> animation;
    double posed_at_s = -1;  ///< clip time of the vertices uploaded last
  };
  void show_mean(const SceneView& scene, std::uint32_t image);
  void pose(ClientMesh& mesh, const InstanceView& instance, double time_s);
  /// Draws what is behind all objects.
  void draw_background(const Camera& camera, const Environment& own, const gl::ViewDepth& depth);
  void draw_shadow_map(const SceneView& scene, const CasterListPtr& casters);
  /// Draws the geometry of the list with a pass that has begun.
  void draw_meshes(gl::MeshPass& pass, const Drawing& d, bool blended);
  void draw_shaded_meshes(const Drawing& d, bool blended);

  ImpostorPass impostors;
  ViewPass view;
  gl::SkyPass sky;
  std::optional<gl::ProbeMap> probe;
  std::unique_ptr<gl::MeshPass> mesh_pass = std::make_unique<gl::MeshPass>(gl::MeshOutput::kColor);
  std::map<std::pair<std::uint32_t, std::uint8_t>, ClientMesh> meshes;  ///< by object and level
  gl::GpuImages images;                                                 ///< images of the scene
  std::vector<Vertex> posed;  ///< scratch for posed vertices
  ShadowAtlas shadow_atlas;
  CasterPass caster_pass;
  std::unique_ptr<gl::MeshPass> caster_meshes =
      std::make_unique<gl::MeshPass>(gl::MeshOutput::kDepth);
  std::unique_ptr<gl::MeshPass> tint_meshes = std::make_unique<gl::MeshPass>(gl::MeshOutput::kTint);
  gl::ShadowMap shadow_map;  ///< made when first needed
  CasterListPtr in_map;      ///< casters that the map shows
  bool background_shown = true;
  std::optional<glm::vec3> background;  ///< in place of the scene's own
  int draw_calls = 0;
};

void FrameRenderer::Parts::show_mean(const SceneView& scene, std::uint32_t index) {
  const ImageDescription& description = scene.images[index];
  Image mean;
  mean.width = mean.height = 1;
  mean.srgb = description.srgb;
  mean.rgba.assign(description.mean.begin(), description.mean.end());
  images.put(index, mean, {});
}

void FrameRenderer::Parts::pose(ClientMesh& mesh, const InstanceView& instance, double time_s) {
  const double clip_time = wrap_clip(time_s + instance.clip_offset_s, mesh.animation->clip_s);
  if (mesh.posed_at_s == clip_time) return;
  mesh.posed_at_s = clip_time;
  pose_vertices(mesh.bind, *mesh.animation, clip_time, posed);
  mesh.mesh.replace_vertices(posed);
}

void FrameRenderer::Parts::draw_shaded_meshes(const Drawing& d, bool blended) {
  if (d.list.meshes.empty()) return;
  const glm::dvec3& eye = d.camera.pose.eye;
  mesh_pass->begin(d.camera.clip_from_relative(d.mapping), gl::light_block(d.lighting, eye),
                   d.mapping);
  mesh_pass->set_shadow(d.list.casters && in_map ? &shadow_map : nullptr, eye);
  draw_meshes(*mesh_pass, d, blended);
  mesh_pass->end();
}

void FrameRenderer::Parts::draw_meshes(gl::MeshPass& pass, const Drawing& d, bool blended) {
  std::map<std::pair<std::uint32_t, std::uint8_t>, std::vector<gl::MeshInstance>> by_mesh;
  std::vector<std::pair<std::uint32_t, std::uint8_t>> order;
  for (const DrawnMesh& drawn : in_drawing_order(d.list.meshes, d.camera, d.scene, blended)) {
    const InstanceView& instance = d.scene.instances[drawn.instance];
    gl::MeshInstance data =
        gl::mesh_instance(instance.world_from_object, d.camera.pose.eye, drawn.instance);
    data.fade = drawn.fade;
    std::vector<gl::MeshInstance>& instances = by_mesh[{instance.object, drawn.lod}];
    if (instances.empty()) order.emplace_back(instance.object, drawn.lod);
    instances.push_back(data);
  }
  for (const auto& mesh : order) {
    const std::vector<gl::MeshInstance>& instances = by_mesh[mesh];
    const auto found = meshes.find(mesh);
    if (found == meshes.end()) continue;
    if (found->second.animation) {
      for (const gl::MeshInstance& one : instances) {
        pose(found->second, d.scene.instances[one.id], d.list.time_s);
        pass.draw(found->second.mesh, found->second.materials, images, &one, 1, blended);
      }
      continue;
    }
    pass.draw(found->second.mesh, found->second.materials, images, instances.data(),
              instances.size(), blended);
  }
}

void FrameRenderer::Parts::draw_background(const Camera& camera, const Environment& own,
                                           const gl::ViewDepth& depth) {
  if (!background_shown) return;
  if (!background) {
    sky.draw_behind(camera, own, depth);
    return;
  }
  Environment flat = own;
  flat.zenith = flat.horizon = flat.nadir = flat.floor.color = *background;
  sky.draw_behind(camera, flat, depth);
}

void FrameRenderer::Parts::draw_shadow_map(const SceneView& scene, const CasterListPtr& casters) {
  if (!casters || casters == in_map) return;
  if (shadow_map.edge() == 0) {
    Result<gl::ShadowMap> map = gl::ShadowMap::create(kShadowMapEdge);
    if (!map) return;  // drawn without shadows
    shadow_map = map.take();
  }
  const SunFrame& frame = casters->frame;
  shadow_map.begin(frame);
  caster_meshes->begin(frame.clip_from_relative(frame.center), {});
  for (const DrawnMesh& drawn : casters->meshes) {
    const InstanceView& instance = scene.instances[drawn.instance];
    const auto found = meshes.find({instance.object, drawn.lod});
    if (found == meshes.end()) continue;
    const gl::MeshInstance one =
        gl::mesh_instance(instance.world_from_object, frame.center, drawn.instance);
    caster_meshes->draw(found->second.mesh, found->second.materials, images, &one, 1, false);
  }
  caster_meshes->end();
  caster_pass.draw(scene, *casters, shadow_atlas.texture());
  in_map = casters;
}

FrameRenderer::FrameRenderer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
FrameRenderer::FrameRenderer(FrameRenderer&& other) noexcept = default;
FrameRenderer& FrameRenderer::operator=(FrameRenderer&& other) noexcept = default;
FrameRenderer::~FrameRenderer() = default;

Result<FrameRenderer> FrameRenderer::create(int atlas_edge, int atlas_layers,
                                            const std::set<DrawMethod>& flat) {
  Result<ImpostorPass> impostors = ImpostorPass::create(atlas_edge, atlas_layers, flat);
  if (!impostors) return impostors.error();
  Result<gl::SkyPass> sky = gl::SkyPass::create();
  if (!sky) return sky.error();
  Result<CasterPass> casters = CasterPass::create();
  if (!casters) return casters.error();
  Result<ViewPass> view = ViewPass::create();
  if (!view) return view.error();
  auto parts = std::make_unique<Parts>();
  parts->view = view.take();
  parts->caster_pass = casters.take();
  parts->impostors = impostors.take();
  parts->sky = std::move(*sky);
  FrameRenderer out(std::move(parts));
  out.sharpen_as_usual();
  return out;
}

void FrameRenderer::sharpen_as_usual() { sharpen(kSharpenLevels, kSharpenTestedLevels); }

Result<void> FrameRenderer::reset(const SceneView& scene) {
  Parts& p = *parts_;
  p.meshes.clear();
  p.in_map.reset();
  p.images = gl::GpuImages();
  p.mesh_pass->set_fog(scene.environment.horizon, scene.environment.fog_density);
  for (std::uint32_t i = 0; i < scene.images.size(); ++i) p.show_mean(scene, i);
  p.probe.reset();
  if (scene.probe) p.probe = gl::ProbeMap::create(*scene.probe);
  p.mesh_pass->set_probe(p.probe ? &*p.probe : nullptr);
  p.mesh_pass->set_surroundings(scene.environment);
  if (Result<void> sky = p.sky.prepare(scene.environment); !sky) return sky;
  return p.impostors.reset(scene);
}

Result<void> FrameRenderer::add_mesh(std::uint32_t object, std::uint8_t lod, ObjectModel model) {
  Parts& p = *parts_;
  Parts::ClientMesh mesh;
  mesh.mesh = gl::GpuMesh(model.mesh, model.animation != nullptr);
  mesh.materials = std::move(model.materials);
  if (model.animation) mesh.bind = std::move(model.mesh.vertices);
  mesh.animation = std::move(model.animation);
  Result<void> compiled = p.mesh_pass->warm_up(mesh.mesh, mesh.materials, true);
  p.meshes[{object, lod}] = std::move(mesh);
  return compiled;
}

void FrameRenderer::add_image(std::uint32_t index, const Image& image,
                              const std::vector<Image>& mips) {
  parts_->images.put(index, image, mips);
}

void FrameRenderer::drop(const SceneView& scene, const AssetId& id) {
  Parts& p = *parts_;
  if (id.kind == AssetId::Kind::kMesh) {
    p.meshes.erase({id.index, id.level});
  } else {
    p.show_mean(scene, id.index);
  }
}

void FrameRenderer::draw(const FrameTarget& target, const PlannedFrame& frame) {
  Parts& p = *parts_;
  const SceneView& scene = *frame.scene;
  const DrawList& list = frame.list;
  p.impostors.reset_draw_calls();
  p.mesh_pass->reset_draw_calls();
  p.draw_shadow_map(scene, list.casters);
  target.bind();
  gl::encode_srgb(true);
  glDepthMask(GL_TRUE);
  const gl::ViewDepth view_depth;
  const Drawing d{target.drawn_camera(frame.camera), view_depth.mapping(), scene, list,
                  frame.lighting};
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  p.draw_shaded_meshes(d, false);
  p.draw_background(d.camera, scene.environment, view_depth);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(gl::nearer_or_equal(d.mapping));
  if (list.view) p.view.draw(d.camera, d.mapping, *list.view);
  p.impostors.draw(d, p.shadow_atlas.texture(), p.probe ? &*p.probe : nullptr);
  p.draw_shaded_meshes(d, true);
  const int view_calls = list.view ? p.view.draw_calls() : 0;
  p.draw_calls = 1 + view_calls + p.impostors.draw_calls() + p.mesh_pass->draw_calls();
}

Result<void> FrameRenderer::draw_tints(const Camera& camera, const PlannedFrame& frame,
                                       const Tints& tints) {
  Parts& p = *parts_;
  gl::MeshPass& pass = *p.tint_meshes;
  pass.set_tint(tints.meshes);
  glDepthMask(GL_TRUE);
  const gl::ViewDepth view_depth;
  const Drawing d{camera, view_depth.mapping(), *frame.scene, frame.list, frame.lighting};
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const auto draw_meshes = [&](bool blended) {
    pass.begin(camera.clip_from_relative(d.mapping), {}, d.mapping);
    p.draw_meshes(pass, d, blended);
    pass.end();
  };
  draw_meshes(false);
  Result<void> drawn = p.impostors.draw_tints(d, tints);
  draw_meshes(true);
  return drawn;
}

GpuBytes FrameRenderer::gpu_bytes() const {
  const Parts& p = *parts_;
  GpuBytes bytes;
  bytes.atlas = p.impostors.gpu_bytes();
  bytes.geometry = p.images.gpu_bytes() + (p.probe ? p.probe->gpu_bytes() : 0);
  for (const auto& [id, mesh] : p.meshes) bytes.geometry += mesh.mesh.gpu_bytes();
  bytes.view = p.view.gpu_bytes();
  bytes.shadows = p.shadow_atlas.gpu_bytes() + p.shadow_map.gpu_bytes();
  return bytes;
}

Result<void> FrameRenderer::upload(const TileRecord& record, const AtlasPlanes& planes) {
  return parts_->impostors.upload(record, planes);
}

Result<void> FrameRenderer::upload_shadow(const ShadowRecord& record,
                                          const std::vector<std::uint8_t>& plane) {
  return parts_->shadow_atlas.upload(record, plane);
}

void FrameRenderer::upload_view(const ViewTile& view) { parts_->view.upload(view); }

void FrameRenderer::sharpen(float levels, float tested_levels) {
  parts_->mesh_pass->sharpen(levels, tested_levels);
}

void FrameRenderer::draw_edges_last(bool on) { parts_->impostors.draw_edges_last(on); }

void FrameRenderer::show_background(bool shown) {
  parts_->background_shown = shown;
  parts_->view.cut_outlines(!shown || parts_->background);
}

void FrameRenderer::set_background(const std::optional<glm::vec3>& color) {
  parts_->background = color;
  parts_->view.cut_outlines(!parts_->background_shown || color);
}

int FrameRenderer::draw_calls() const { return parts_->draw_calls; }

}  // namespace mirage

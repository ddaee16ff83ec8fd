#include "client/draw/frame_renderer.h"

#include <algorithm>

namespace mirage {
namespace {
// A pixel's mip level is half a level blurrier than the mean of samples that each chose their own.
constexpr float kSharpenLevels = 0.75f;
constexpr float kSharpenTestedLevels = 1.5f;  // they are tested for every sample

// Near ones first, as they hide what is drawn later; blended ones last, over what is behind them.
std::vector<DrawnMesh> in_drawing_order(std::vector<DrawnMesh> meshes, const Camera& camera,
                                        const SceneView& scene, bool blended) {
  const auto distance = [&](const DrawnMesh& drawn) {
    const InstanceView& view = scene.instances[drawn.instance];
    return glm::length(view.center - camera.pose.eye) - view.radius;
  };
  std::stable_sort(meshes.begin(), meshes.end(), [&](const DrawnMesh& a, const DrawnMesh& b) {
    return blended ? distance(a) > distance(b) : distance(a) < distance(b);
  });
  return meshes;
}
}  // namespace

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
  FrameRenderer out;
  out.view_ = view.take();
  out.casters_ = casters.take();
  out.impostors_ = impostors.take();
  out.sky_ = std::move(*sky);
  out.sharpen_as_usual();
  return out;
}

void FrameRenderer::sharpen_as_usual() { sharpen(kSharpenLevels, kSharpenTestedLevels); }

Result<void> FrameRenderer::reset(const SceneView& scene) {
  meshes_.clear();
  in_map_.reset();
  images_ = gl::GpuImages();
  mesh_pass_->set_fog(scene.environment.horizon, scene.environment.fog_density);
  for (std::uint32_t i = 0; i < scene.images.size(); ++i) show_mean(scene, i);
  probe_.reset();
  if (scene.probe) probe_ = gl::ProbeMap::create(*scene.probe);
  mesh_pass_->set_probe(probe_ ? &*probe_ : nullptr);
  mesh_pass_->set_backdrop(scene.environment.horizon);
  return impostors_.reset(scene);
}

void FrameRenderer::show_mean(const SceneView& scene, std::uint32_t index) {
  const ImageDescription& description = scene.images[index];
  Image mean;
  mean.width = mean.height = 1;
  mean.srgb = description.srgb;
  mean.rgba.assign(description.mean.begin(), description.mean.end());
  images_.put(index, mean, 0);
}

Result<void> FrameRenderer::add_mesh(std::uint32_t object, std::uint8_t lod, ObjectModel model) {
  ClientMesh mesh;
  mesh.mesh = gl::GpuMesh(model.mesh);
  mesh.materials = std::move(model.materials);
  if (model.animation) mesh.bind = std::move(model.mesh.vertices);
  mesh.animation = std::move(model.animation);
  Result<void> compiled = mesh_pass_->warm_up(mesh.mesh, mesh.materials, true);
  meshes_[{object, lod}] = std::move(mesh);
  return compiled;
}

void FrameRenderer::add_image(const SceneView& scene, std::uint32_t index, const Image& image) {
  images_.put(index, image, scene.images[index].alpha_cutoff);
}

void FrameRenderer::drop(const SceneView& scene, const AssetId& id) {
  if (id.kind == AssetId::Kind::kMesh) {
    meshes_.erase({id.index, id.level});
  } else {
    show_mean(scene, id.index);
  }
}

void FrameRenderer::pose(ClientMesh& mesh, const InstanceView& instance, double time_s) {
  const double clip_time = wrap_clip(time_s + instance.clip_offset_s, mesh.animation->clip_s);
  if (mesh.posed_at_s == clip_time) return;
  mesh.posed_at_s = clip_time;
  pose_vertices(mesh.bind, *mesh.animation, clip_time, posed_);
  mesh.mesh.replace_vertices(posed_);
}

void FrameRenderer::draw_meshes(const Camera& camera, const SceneView& scene, const DrawList& list,
                                const Lighting& lighting, bool blended, DepthMapping mapping) {
  if (list.meshes.empty()) return;
  mesh_pass_->begin(camera.clip_from_relative(mapping), gl::light_block(lighting, camera.pose.eye),
                    mapping);
  mesh_pass_->set_shadow(list.casters && in_map_ ? &shadow_map_ : nullptr, camera.pose.eye);
  std::map<std::pair<std::uint32_t, std::uint8_t>, std::vector<gl::MeshInstance>> by_mesh;
  std::vector<std::pair<std::uint32_t, std::uint8_t>> order;
  for (const DrawnMesh& drawn : in_drawing_order(list.meshes, camera, scene, blended)) {
    const InstanceView& instance = scene.instances[drawn.instance];
    gl::MeshInstance data =
        gl::mesh_instance(instance.world_from_object, camera.pose.eye, drawn.instance);
    data.fade = drawn.fade;
    std::vector<gl::MeshInstance>& instances = by_mesh[{instance.object, drawn.lod}];
    if (instances.empty()) order.emplace_back(instance.object, drawn.lod);
    instances.push_back(data);
  }
  for (const auto& mesh : order) {
    const std::vector<gl::MeshInstance>& instances = by_mesh[mesh];
    const auto found = meshes_.find(mesh);
    if (found == meshes_.end()) continue;
    if (found->second.animation) {
      for (const gl::MeshInstance& one : instances) {
        pose(found->second, scene.instances[one.id], list.time_s);
        mesh_pass_->draw(found->second.mesh, found->second.materials, images_, &one, 1, blended);
      }
      continue;
    }
    mesh_pass_->draw(found->second.mesh, found->second.materials, images_, instances.data(),
                     instances.size(), blended);
  }
  mesh_pass_->end();
}

void FrameRenderer::draw_shadow_map(const SceneView& scene, const CasterListPtr& casters) {
  if (!casters || casters == in_map_) return;
  if (shadow_map_.edge() == 0) {
    Result<gl::ShadowMap> map = gl::ShadowMap::create(kShadowMapEdge);
    if (!map) return;  // drawn without shadows
    shadow_map_ = map.take();
  }
  const SunFrame& frame = casters->frame;
  shadow_map_.begin(frame);
  caster_meshes_->begin(frame.clip_from_relative(frame.center), {});
  for (const DrawnMesh& drawn : casters->meshes) {
    const InstanceView& instance = scene.instances[drawn.instance];
    const auto found = meshes_.find({instance.object, drawn.lod});
    if (found == meshes_.end()) continue;
    const gl::MeshInstance one =
        gl::mesh_instance(instance.world_from_object, frame.center, drawn.instance);
    caster_meshes_->draw(found->second.mesh, found->second.materials, images_, &one, 1, false);
  }
  caster_meshes_->end();
  casters_.draw(scene, *casters, shadow_atlas_.texture());
  in_map_ = casters;
}

void FrameRenderer::draw(const FrameTarget& target, const Camera& shown, const SceneView& scene,
                         const DrawList& list, const Lighting& lighting) {
  const Camera camera = target.drawn_camera(shown);
  impostors_.reset_draw_calls();
  mesh_pass_->reset_draw_calls();
  draw_shadow_map(scene, list.casters);
  target.bind();
  glEnable(GL_FRAMEBUFFER_SRGB);
  glDepthMask(GL_TRUE);
  const gl::ViewDepth view_depth;
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  draw_meshes(camera, scene, list, lighting, false, view_depth.mapping());
  sky_.draw_behind(camera, scene.environment, view_depth.farthest());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(gl::nearer_or_equal(view_depth.mapping()));
  if (list.view) view_.draw(camera, view_depth.mapping(), *list.view);
  impostors_.draw(camera, view_depth.mapping(), scene, list, lighting, shadow_atlas_.texture(),
                  probe_ ? &*probe_ : nullptr);
  draw_meshes(camera, scene, list, lighting, true, view_depth.mapping());
  const int view_calls = list.view ? view_.draw_calls() : 0;
  draw_calls_ = 1 + view_calls + impostors_.draw_calls() + mesh_pass_->draw_calls();
}

GpuBytes FrameRenderer::gpu_bytes() const {
  GpuBytes bytes;
  bytes.atlas = impostors_.gpu_bytes();
  bytes.geometry = images_.gpu_bytes() + (probe_ ? probe_->gpu_bytes() : 0);
  for (const auto& [id, mesh] : meshes_) bytes.geometry += mesh.mesh.gpu_bytes();
  bytes.view = view_.gpu_bytes();
  bytes.shadows = shadow_atlas_.gpu_bytes() + shadow_map_.gpu_bytes();
  return bytes;
}

}  // namespace mirage

#include "server/render/scene_shadow.h"

#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"

namespace mirage {

SceneShadow::SceneShadow(const GpuScene& scene)
    : scene_(&scene),
      casters_(scene.prepared->scene.objects.size()),
      meshes_(std::make_unique<gl::MeshPass>(gl::MeshOutput::kDepth)) {
  const PreparedScene& prepared = *scene.prepared;
  for (std::uint32_t i = 0; i < prepared.scene.instances.size(); ++i) {
    const std::uint32_t object = prepared.scene.instances[i].object;
    if (prepared.objects[object].casts()) casters_[object].push_back(i);
  }
}

Result<SceneShadow> SceneShadow::create(const GpuScene& scene) {
  SceneShadow out(scene);
  Result<gl::ShadowMap> map = gl::ShadowMap::create(kShadowMapEdge);
  if (!map) return map.error();
  out.map_ = map.take();
  for (const gl::GpuMesh& mesh : scene.meshes) {
    if (Result<void> warm = out.meshes_->warm_up(mesh, scene.materials(), false); !warm) {
      return warm.error();
    }
  }
  return out;
}

const gl::ShadowMap* SceneShadow::map_for(const Lighting& lighting) {
  const Light* sun = sun_of(lighting);
  if (!sun) return nullptr;
  if (sun->direction == drawn_for_) return &map_;
  drawn_for_ = sun->direction;
  const PreparedScene& prepared = *scene_->prepared;
  const SunFrame frame(sun->direction, prepared.bounds_center, prepared.bounds_radius,
                       kShadowMapEdge);
  map_.begin(frame);
  meshes_->begin(frame.clip_from_relative(frame.center), {});
  std::vector<gl::MeshInstance> instances;
  for (std::size_t object = 0; object < casters_.size(); ++object) {
    if (casters_[object].empty()) continue;
    instances.clear();
    for (const std::uint32_t i : casters_[object]) {
      instances.push_back(
          gl::mesh_instance(prepared.scene.instances[i].world_from_object, frame.center, i));
    }
    meshes_->draw(scene_->meshes[object], scene_->materials(), scene_->images, instances.data(),
                  instances.size(), false);
  }
  meshes_->end();
  return &map_;
}

}  // namespace mirage

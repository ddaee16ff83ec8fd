#include "server/render/gpu_scene.h"

#include <utility>

#include "protocol/impostor/capture.h"
#include "protocol/impostor/lod.h"
#include "protocol/model/animation.h"
#include "server/prepare/prepared_scene.h"

namespace mirage {

GpuScene::GpuScene(std::shared_ptr<const PreparedScene> scene)
    : prepared(std::move(scene)),
      parts(std::make_unique<std::vector<gl::GpuMesh>>(prepared->parts.size())) {
  for (std::size_t i = 0; i < prepared->scene.images.size(); ++i) {
    images.put(i, prepared->scene.images[i], prepared->mips[i]);
  }
  if (prepared->scene.probe) probe = gl::ProbeMap::create(*prepared->scene.probe);
  for (const SceneObject& object : prepared->scene.objects) {
    meshes.emplace_back(object.mesh, object.animation != nullptr);
  }
  upload_levels();
}

void GpuScene::upload_levels() {
  tile_lods.clear();
  for (const ObjectGeometry& geometry : prepared->geometry) {
    std::vector<gl::GpuMesh>& lods = tile_lods.emplace_back();
    for (const Mesh& mesh : geometry.tile_lods) {
      lods.push_back(mesh.primitives.empty() ? gl::GpuMesh() : gl::GpuMesh(mesh));
    }
  }
}

std::size_t GpuScene::gpu_bytes() const {
  std::size_t bytes = images.gpu_bytes() + (probe ? probe->gpu_bytes() : 0);
  for (const gl::GpuMesh& mesh : meshes) bytes += mesh.gpu_bytes();
  for (const std::vector<gl::GpuMesh>& lods : tile_lods) {
    for (const gl::GpuMesh& mesh : lods) bytes += mesh.gpu_bytes();
  }
  for (const gl::GpuMesh& mesh : *parts) bytes += mesh.gpu_bytes();
  return bytes;
}

const gl::GpuMesh& GpuScene::mesh_for_tile(std::uint32_t object, const Capture& capture) const {
  return level(object, lod_for_tile(prepared->objects[object].lods, capture));
}

const gl::GpuMesh& GpuScene::mesh_for_group(std::uint32_t object, float scale,
                                            const Capture& capture) const {
  const double allowed = allowed_tile_error(capture) / double{scale};
  return level(object, lod_within(prepared->objects[object].lods, allowed));
}

const gl::GpuMesh& GpuScene::part(std::uint32_t index) const {
  gl::GpuMesh& mesh = (*parts)[index];
  if (mesh.primitives().empty()) mesh = gl::GpuMesh(prepared->parts[index]);
  return mesh;
}

const std::vector<Material>& GpuScene::materials() const { return prepared->scene.materials; }

const gl::GpuMesh& GpuScene::posed_mesh(std::uint32_t object, double clip_time_s) const {
  const SceneObject& source = prepared->scene.objects[object];
  if (!source.animation) return meshes[object];
  if (poser->object != object || poser->clip_time_s != clip_time_s) {
    *poser = {object, clip_time_s, std::move(poser->vertices)};
    pose_vertices(source.mesh.vertices, *source.animation, clip_time_s, poser->vertices);
    meshes[object].replace_vertices(poser->vertices);
  }
  return meshes[object];
}

}  // namespace mirage

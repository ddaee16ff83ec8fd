#pragma once
#include <memory>
#include <vector>

#include "server/scene/prepared_scene.h"
#include "shaders/gl/gpu_model.h"

namespace mirage {

/// The whole scene on the GPU; lives on the GL thread.
struct GpuScene {
  std::shared_ptr<const PreparedScene> prepared;
  gl::GpuImages images;
  std::vector<gl::GpuMesh> meshes;

  explicit GpuScene(std::shared_ptr<const PreparedScene> scene) : prepared(std::move(scene)) {
    images = gl::GpuImages(prepared->scene.images, prepared->scene.materials);
    for (const SceneObject& object : prepared->scene.objects) meshes.emplace_back(object.mesh);
  }
  const std::vector<Material>& materials() const { return prepared->scene.materials; }
};

}  // namespace mirage

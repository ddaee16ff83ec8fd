#pragma once
// The scene's shadow map: all casters as seen from the sun of a lighting, around the whole scene,
// so that a tile's shadows depend on its key alone. GL thread only.

#include <memory>

#include "server/render/gpu_scene.h"
#include "shaders/gl/mesh_pass.h"

namespace mirage {

class SceneShadow {
 public:
  /// Errors kGraphicsShader, kGraphicsGl.
  static Result<SceneShadow> create(const GpuScene& scene);

  /// Returns the map; nullptr: the lighting has no sun. If the sun turned since the last call, the
  /// map is drawn again, which binds another framebuffer.
  const gl::ShadowMap* map_for(const Lighting& lighting);
  std::size_t gpu_bytes() const { return map_.gpu_bytes(); }

 private:
  explicit SceneShadow(const GpuScene& scene);

  const GpuScene* scene_;
  std::vector<std::vector<std::uint32_t>> casters_;  ///< instances, by object
  std::unique_ptr<gl::MeshPass> meshes_;
  gl::ShadowMap map_;
  glm::vec3 drawn_for_{0};  ///< direction of the light
};

}  // namespace mirage

#pragma once
// The full scene for a camera: the truth the client's picture is compared with. GL thread only.

#include "protocol/camera.h"
#include "server/render/gpu_scene.h"
#include "server/render/scene_shadow.h"
#include "server/tile_job.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/render_target.h"
#include "shaders/gl/sky_pass.h"

namespace mirage {

class ReferenceRenderer {
 public:
  /// `shadow`, which must live as long, gives the sun's shadows; nullptr: there are none.
  static Result<ReferenceRenderer> create(const GpuScene& scene, SceneShadow* shadow = nullptr);

  /// Whole reply message: RGBA8 (sRGB, alpha = coverage by objects), then eye depth (float, m, 0 =
  /// none), then instance + 1 (u32, 0 = none), each width x height, top row first, zstd.
  /// Error kGraphicsGl when the target is too large for the device.
  Result<Bytes> render(const ReferenceJob& job);
  /// Graphics memory that takes while it is drawn, bytes.
  std::size_t gpu_bytes(const ReferenceJob& job) const;

 private:
  explicit ReferenceRenderer(const GpuScene& scene);
  std::vector<GLenum> drawn_formats() const;
  void draw_scene(const Camera& camera, const Lighting& lighting, DepthMapping mapping);
  /// Those with blended surfaces, in the order they are drawn: farthest first.
  std::vector<std::uint32_t> blended_instances(const Camera& camera) const;
  void draw_blended(gl::MeshPass& pass, const Camera& camera, std::uint32_t instance);
  /// One instance in its pose at the time of the job.
  void draw_moving(gl::MeshPass& pass, const gl::MeshInstance& instance, bool blended);

  const GpuScene* scene_;
  SceneShadow* shadow_ = nullptr;
  std::vector<std::vector<std::uint32_t>> instances_of_object_;
  std::unique_ptr<gl::MeshPass> meshes_;
  std::unique_ptr<gl::MeshPass> fronts_;  ///< depth and id of blended surfaces
  gl::SkyPass sky_;
  gl::Program resolve_;
  gl::VertexArray empty_vao_;
  double time_s_ = 0;  ///< animation time of the job being drawn
};

}  // namespace mirage

#pragma once
// The full scene for a camera: the truth the client's picture is compared with, and, from levels of
// detail, views. GL thread only.

#include "protocol/impostor/camera.h"
#include "server/tile/tile_job.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/render_target.h"
#include "shaders/gl/sky_pass.h"

namespace mirage {

struct GpuScene;
class SceneShadow;

class ReferenceRenderer {
 public:
  /// `shadow`, which must live as long, gives the sun's shadows; nullptr: there are none.
  static Result<ReferenceRenderer> create(const GpuScene& scene, SceneShadow* shadow = nullptr);

  /// Compiles what draws the scene. Error kGraphicsShader.
  Result<void> warm_up();
  /// Error kGraphicsGl when the target is too large for the device.
  Result<SceneFrame> draw(const SceneShot& shot);
  /// Whole reply message: the planes of a SceneFrame, one after the other, zstd. Errors as draw().
  Result<Bytes> render(const ReferenceJob& job);
  /// Graphics memory that takes while it is drawn, bytes.
  std::size_t gpu_bytes(const SceneShot& shot) const;

 private:
  explicit ReferenceRenderer(const GpuScene& scene);
  std::vector<GLenum> drawn_formats() const;
  void draw_scene(const SceneShot& shot, DepthMapping mapping);
  struct Visible {
    std::uint32_t object = 0;
    std::size_t level = 0;  ///< of detail
    std::uint32_t instance = 0;
    double size_px = 0;  ///< radius
  };
  /// What may be seen, by object and level.
  std::vector<Visible> visible(const SceneShot& shot) const;
  /// The level of detail of an instance whose sphere is `distance` metres away.
  std::size_t level_of(const SceneShot& shot, const Instance& instance, double distance) const;
  /// Those with blended surfaces, in the order they are drawn: farthest first.
  std::vector<std::uint32_t> blended_instances(const Camera& camera) const;
  void draw_blended(gl::MeshPass& pass, const Camera& camera, std::uint32_t instance);
  /// One instance in its pose at the time of the job.
  void draw_moving(gl::MeshPass& pass, const gl::MeshInstance& instance, bool blended);

  const GpuScene* scene_;
  SceneShadow* shadow_ = nullptr;
  std::unique_ptr<gl::MeshPass> meshes_;
  std::unique_ptr<gl::MeshPass> fronts_;  ///< depth and id of blended surfaces
  gl::SkyPass sky_;
  gl::Program resolve_;
  gl::VertexArray empty_vao_;
  double time_s_ = 0;  ///< animation time of what is being drawn
};

}  // namespace mirage

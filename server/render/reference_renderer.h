#pragma once
// The full scene for a camera: the truth the client's picture is compared with, and, from levels of
// detail, views. A picture is drawn a slice at a time, so that tiles can be drawn between two of
// them; how it is cut changes none of its bytes, but where surfaces of two instances coincide. GL
// thread only.

#include <memory>
#include <optional>

#include "server/tile/tile_job.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/render_target.h"
#include "shaders/gl/sky_pass.h"

namespace mirage {

struct GpuScene;
struct FramePiece;
class SceneShadow;

class ReferenceRenderer {
 public:
  /// Work, in samples shaded, beyond any picture's.
  static constexpr double kWholeSlice = 1e18;

  ReferenceRenderer(ReferenceRenderer&& other) noexcept;
  ReferenceRenderer& operator=(ReferenceRenderer&& other) noexcept;
  ~ReferenceRenderer();
  /// `shadow`, which must live as long, gives the sun's shadows; nullptr: there are none.
  static Result<ReferenceRenderer> create(const GpuScene& scene, SceneShadow* shadow = nullptr);

  /// Compiles what draws the scene. Error kGraphicsShader.
  Result<void> warm_up();

  /// A picture to draw, in place of one that may be under way, in slices of about so much work.
  /// Error kGraphicsGl when its targets cannot be made.
  Result<void> begin(const SceneShot& shot, double slice_samples = kWholeSlice);
  bool under_way() const { return progress_ != nullptr; }
  /// Draws a slice and waits for it. The picture, once it is whole. One must be under way.
  std::optional<SceneFrame> draw_slice();
  /// The picture that is under way is not wanted.
  void drop();

  /// A picture in one go. Errors as begin().
  Result<SceneFrame> draw(const SceneShot& shot);
  /// Graphics memory of a picture's targets, bytes.
  std::size_t gpu_bytes(const SceneShot& shot) const;
  /// Of those there are: they stay for the next of the same size.
  std::size_t gpu_bytes() const { return drawn_.gpu_bytes() + kept_.gpu_bytes(); }

 private:
  struct Progress;

  explicit ReferenceRenderer(const GpuScene& scene);
  std::vector<GLenum> drawn_formats() const;
  void aim_at_band() const;
  /// Clears it, draws the sky, lists what there is to draw.
  void begin_band(float far_depth);
  /// Until there is none left, or `most` samples' work is done; what was done, in samples.
  double draw_pieces(double most, DepthMapping mapping);
  void draw_piece(gl::MeshPass& pass, const FramePiece& piece, bool blended);
  /// Averages its samples and reads it back.
  void finish_band(const gl::ViewDepth& view_depth);

  const GpuScene* scene_;
  SceneShadow* shadow_ = nullptr;
  std::unique_ptr<gl::MeshPass> meshes_;
  std::unique_ptr<gl::MeshPass> fronts_;  ///< depth and id of blended surfaces
  gl::SkyPass sky_;
  gl::Program resolve_;
  gl::VertexArray empty_vao_;
  gl::RenderTarget drawn_, kept_;
  std::unique_ptr<Progress> progress_;  ///< null: nothing is under way
};

}  // namespace mirage

#pragma once
// Renders the full scene for a camera: the truth that the client's picture is compared with, and
// views, from levels of detail. A picture is drawn slice by slice, so tiles can be drawn in
// between. The slicing changes no byte, except where surfaces of two instances coincide. GL thread
// only.

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
  /// A work limit, in samples shaded, above that of any picture.
  static constexpr double kWholeSlice = 1e18;

  ReferenceRenderer(ReferenceRenderer&& other) noexcept;
  ReferenceRenderer& operator=(ReferenceRenderer&& other) noexcept;
  ~ReferenceRenderer();
  /// `shadow`, which must outlive this object, adds the sun's shadows; nullptr: no shadows.
  static Result<ReferenceRenderer> create(const GpuScene& scene, SceneShadow* shadow = nullptr);

  /// Compiles the shaders of the scene. Error kGraphicsShader.
  Result<void> warm_up();

  /// Begins a picture, in slices of about the given work; a picture under way is dropped. Error
  /// kGraphicsGl: its targets cannot be made.
  Result<void> begin(const SceneShot& shot, double slice_samples = kWholeSlice);
  bool under_way() const { return progress_ != nullptr; }
  /// Draws a slice and waits for it. Returns the picture once it is complete. One must be under
  /// way.
  std::optional<SceneFrame> draw_slice();
  /// Abandons the picture under way.
  void drop();

  /// Draws a whole picture. Errors as begin().
  Result<SceneFrame> draw(const SceneShot& shot);
  /// Returns the graphics memory of a picture's targets, bytes.
  std::size_t gpu_bytes(const SceneShot& shot) const;
  /// Bytes of graphics memory that the present targets hold; they stay for the next picture of the
  /// same size.
  std::size_t gpu_bytes() const { return drawn_.gpu_bytes() + kept_.gpu_bytes(); }

 private:
  struct Progress;

  explicit ReferenceRenderer(const GpuScene& scene);
  std::vector<GLenum> drawn_formats() const;
  void aim_at_band() const;
  /// Clears the band, draws the sky, and lists the pieces.
  void begin_band(float far_depth);
  /// Draws pieces until none is left or `most` samples of work are done. Returns the work done, in
  /// samples.
  double draw_pieces(double most, DepthMapping mapping);
  void draw_piece(gl::MeshPass& pass, const FramePiece& piece, bool blended);
  /// Averages the band's samples and reads it back.
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

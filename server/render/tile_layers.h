#pragma once
// The second layer of tiles of foliage: what lies behind the front of each texel, peeled off by
// drawing the object again without all that is nearer. GL thread only.

#include <map>

#include "server/render/row_band.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/program.h"
#include "shaders/gl/render_target.h"

namespace mirage {

class TileLayers {
 public:
  TileLayers() : meshes_(gl::MeshOutput::kBehind) {}
  /// For tiles of so many samples an axis, once. Error kGraphicsShader.
  Result<void> compile(int samples);

  /// Draws what lies behind: between begin() and end().
  gl::MeshPass& meshes() { return meshes_; }

  /// Formats of the peeled target's colours; its depth is GL_DEPTH_COMPONENT32F. And of the
  /// floor's.
  gl::RenderTarget& peeled() { return peeled_; }
  gl::RenderTarget& floor() { return floor_; }
  std::size_t gpu_bytes() const { return peeled_.gpu_bytes() + floor_.gpu_bytes(); }

  /// Binds the peeled target, cleared, for what lies behind `first`: rows of a tile of `edge`
  /// texels.
  void begin(const gl::RenderTarget& first, int edge, const RowBand& rows, int samples);
  /// Both layers into the page that is bound, where its viewport is: `x`, `y` from its corner.
  void resolve(const gl::RenderTarget& first, int x, int y, int samples);

 private:
  struct Programs {
    gl::Program floor, resolve;
  };
  std::map<int, Programs> programs_;  ///< by samples
  gl::MeshPass meshes_;
  gl::RenderTarget peeled_, floor_;
  gl::VertexArray empty_vao_;
};

}  // namespace mirage

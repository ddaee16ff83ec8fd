#pragma once
// The second layer of foliage tiles: the surfaces behind the front of each texel. The object is
// drawn again without everything nearer. GL thread only.

#include <map>

#include "server/render/row_band.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/program.h"
#include "shaders/gl/render_target.h"

namespace mirage {

class TileLayers {
 public:
  TileLayers() : meshes_(gl::MeshOutput::kBehind) {}
  /// Compiles the programs for so many samples per axis, once. Error kGraphicsShader.
  Result<void> compile(int samples);

  /// Returns the pass that draws the layer behind, between begin() and end().
  gl::MeshPass& meshes() { return meshes_; }

  /// The targets of the peeled layer (depth GL_DEPTH_COMPONENT32F) and of the floor. The caller
  /// makes them.
  gl::RenderTarget& peeled() { return peeled_; }
  gl::RenderTarget& floor() { return floor_; }
  std::size_t gpu_bytes() const { return peeled_.gpu_bytes() + floor_.gpu_bytes(); }

  /// Binds and clears the peeled target, for the layer behind `first`: rows of a tile of `edge`
  /// texels.
  void begin(const gl::RenderTarget& first, int edge, const RowBand& rows, int samples);
  /// Resolves both layers into the bound page at its viewport; `x`, `y`: from its corner.
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

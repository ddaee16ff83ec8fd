#pragma once
// Keeps the tiles of an object clear of what touches it (touching.h). Where a surface of another
// instance lies just in front of the tile's own, the stored depth is pushed back so far that, drawn
// from the tile, it never covers the other. The tiles of a group show nothing of what the ground
// hides. GL thread only.
//
// The pushed texels are hidden in the tile's own view. The bound holds for them as for all: a point
// counts as seen by the tile only if it lies within a tolerance of the stored depth.

#include <vector>

#include "protocol/impostor/capture.h"
#include "server/render/row_band.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/render_target.h"

namespace mirage {

struct GpuScene;

class TouchingDepth {
 public:
  explicit TouchingDepth(const GpuScene& scene) : scene_(&scene) {}

  /// The target of the copied depths: depth GL_DEPTH_COMPONENT32F. The caller makes it.
  gl::RenderTarget& own() { return own_; }
  std::size_t gpu_bytes() const { return own_.gpu_bytes(); }
  /// Compiles the shaders for everything that touches something. Error kGraphicsShader.
  Result<void> warm_up();

  /// Where a tile is drawn from. `eye` and positions are in a space that `world_from_space` places.
  struct View {
    Capture capture;
    glm::mat4 clip_from_relative{1};
    glm::dvec3 eye{0};
    Similarity world_from_space;
  };
  /// Pushes depths of the tile on `drawn`, in these rows of `width` samples. `instances` of the
  /// scene touch its object.
  void push(const gl::RenderTarget& drawn, int width, const RowBand& rows, const View& view,
            const std::vector<std::uint32_t>& instances);
  /// Draws the depth of instances of the scene on the bound target, between the capture's planes.
  /// Colours of the target stay as they are.
  void draw_ground(const View& view, const std::vector<std::uint32_t>& instances);

 private:
  void draw_with(gl::MeshPass& meshes, const View& view,
                 const std::vector<std::uint32_t>& instances);

  const GpuScene* scene_;
  gl::MeshPass pushed_{gl::MeshOutput::kClear};
  gl::MeshPass ground_{gl::MeshOutput::kDepth};
  gl::RenderTarget own_;
};

}  // namespace mirage

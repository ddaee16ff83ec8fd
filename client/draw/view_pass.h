#pragma once
// View pass: draws a view tile by its depth, as a grid of cells, each where it was seen. GLES 3.0
// subset. GL thread only.

#include <glm/glm.hpp>
#include <vector>

#include "client/frame/draw_list.h"
#include "protocol/base/result.h"
#include "protocol/impostor/view_tile.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

class ViewPass {
 public:
  /// Creates the pass. Error kGraphicsShader.
  static Result<ViewPass> create();

  /// Replaces the view.
  void upload(const ViewTile& view);
  /// Leaves out cells at outlines from now on: the server's background is mixed into them.
  void cut_outlines(bool on);
  /// Draws the cells of the owners that `drawn` shows. The caller sets the depth test.
  void draw(const Camera& camera, DepthMapping mapping, const DrawnView& drawn);

  int draw_calls() const { return draw_calls_; }
  std::size_t gpu_bytes() const { return gpu_bytes_; }

 private:
  void show(const std::vector<bool>& owners);

  gl::Program program_;
  gl::VertexArray vao_;
  gl::Buffer vertices_, indices_;
  gl::Texture color_;
  std::uint32_t columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> depth_;    ///< depth codes of the view tile
  std::vector<std::uint16_t> owners_;  ///< owners of the view tile
  glm::dvec3 eye_{0};
  bool cut_outlines_ = false;
  std::vector<bool> shown_;  ///< owners that the indices are made for
  std::size_t index_count_ = 0;
  std::size_t gpu_bytes_ = 0;
  int draw_calls_ = 0;
};

}  // namespace mirage

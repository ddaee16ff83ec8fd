#pragma once
#include <cstdint>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"
#include "shaders/gl/view_depth.h"

namespace mirage::gl {

/// Fills the target with the environment, alpha 0; both ends use it.
class SkyPass {
 public:
  static Result<SkyPass> create();
  /// Makes ready for an environment with a floor, so that its first draw need not. Error
  /// kGraphicsShader.
  Result<void> prepare(const Environment& environment);
  void draw(const Camera& camera, const Environment& environment);
  /// Fills only pixels where nothing has been drawn, which have the cleared depth. Afterwards the
  /// depth function keeps nearer surfaces. The earlier depth function is not queried, because in a
  /// browser the answer waits for all earlier draws.
  void draw_behind(const Camera& camera, const Environment& environment,
                   const ViewDepth& view_depth);

 private:
  void fill(const Camera& camera, const Environment& environment);

  Program program_;
  Program over_floor_;
  Texture shadow_;                      ///< of the floor
  std::vector<std::uint8_t> uploaded_;  ///< what the texture holds
  VertexArray vao_;
};

}  // namespace mirage::gl

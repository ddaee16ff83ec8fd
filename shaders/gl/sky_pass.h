#pragma once
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"
#include "shaders/gl/view_depth.h"

namespace mirage::gl {

/// Fills the target with the environment, alpha 0; the same on both ends.
class SkyPass {
 public:
  static Result<SkyPass> create();
  void draw(const Camera& camera, const Environment& environment);
  /// The same where nothing has been drawn yet: depth is what it was cleared to. Afterwards what is
  /// nearer passes. What the depth function was before is not asked: in a browser the answer comes
  /// when all that was drawn before is done.
  void draw_behind(const Camera& camera, const Environment& environment,
                   const ViewDepth& view_depth);

 private:
  void fill(const Camera& camera, const Environment& environment);

  Program program_;
  VertexArray vao_;
};

}  // namespace mirage::gl

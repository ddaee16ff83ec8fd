#pragma once
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage::gl {

/// Fills the target with the environment, alpha 0; the same on both ends.
class SkyPass {
 public:
  static Result<SkyPass> create();
  void draw(const Camera& camera, const Environment& environment);
  /// The same where nothing has been drawn yet: depth is what it was cleared to, `farthest`.
  void draw_behind(const Camera& camera, const Environment& environment, float farthest);

 private:
  void fill(const Camera& camera, const Environment& environment);

  Program program_;
  VertexArray vao_;
};

}  // namespace mirage::gl

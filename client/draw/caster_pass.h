#pragma once
// Caster pass: draws caster tiles into a shadow map, in one instanced call. GLES 3.0 subset.

#include "client/frame/caster_list.h"
#include "client/scene/scene_view.h"
#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

class CasterPass {
 public:
  /// Creates the pass. Error kGraphicsShader.
  static Result<CasterPass> create();

  /// Draws into the bound map. `atlas` is the texture of ShadowAtlas.
  void draw(const SceneView& scene, const CasterList& list, GLuint atlas);

 private:
  gl::Program program_;
  gl::VertexArray quad_;
  gl::Buffer corners_, instances_;
};

}  // namespace mirage

#pragma once
// Captures a subject from every vertex of a lattice. GL thread only.

#include <functional>
#include <memory>

#include "protocol/base/result.h"
#include "server/bake/bake_subject.h"
#include "server/bake/master.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/program.h"
#include "shaders/gl/render_target.h"

namespace mirage {

struct GpuScene;

/// A capture to be made.
struct BakeShot {
  BakeLayout layout = BakeLayout::kHemi;
  RollRule roll;
  int grid = 16;         ///< frames a side
  int tile = 128;        ///< texels a side of a frame
  int samples = 2;       ///< samples of a texel each way, 1 to 4
  glm::dvec3 center{0};  ///< metres
  double radius = 1;     ///< metres; a frame spans centre +- radius
};

class BakeRenderer {
 public:
  /// `scene` outlives this object.
  explicit BakeRenderer(const GpuScene& scene);
  ~BakeRenderer();

  /// Captures all frames. `told` receives the share that is done, 0 to 1, and ends the bake if it
  /// returns false. Errors kGraphicsShader, kGraphicsGl (targets cannot be made; the hint says of
  /// which size), kUsage (ended by `told`).
  Result<BakeMaster> bake(const BakeSubject& subject, const BakeShot& shot,
                          const std::function<bool(double)>& told = {});

  /// One picture of a subject as a camera sees it, for comparison: surfaces, not shaded.
  struct Picture {
    int edge = 0;
    std::vector<glm::vec4> color;   ///< premultiplied, linear; the top row first
    std::vector<glm::vec3> normal;  ///< metres' space, unit length
  };
  /// Draws the whole meshes through `clip_from_relative`, whose positions are relative to `eye`.
  Result<Picture> draw(const BakeSubject& subject, const glm::mat4& clip_from_relative,
                       const glm::dvec3& eye, int edge, int samples);

 private:
  struct Strip;
  Result<void> prepare(const BakeSubject& subject, int edge, int samples);
  void draw_parts(gl::MeshPass& pass, const BakeSubject& subject, const glm::dvec3& eye,
                  double allowed, bool blended);
  void draw_frame(const BakeSubject& subject, const glm::mat4& clip_from_relative,
                  const glm::dvec3& eye, int edge, int samples, double allowed);
  void draw_fronts(const BakeSubject& subject, const glm::mat4& clip_from_relative,
                   const glm::dvec3& eye, double allowed, float least_alpha);
  void resolve(int x, int edge, bool blended);

  const GpuScene* scene_;
  gl::MeshPass meshes_{gl::MeshOutput::kSurface};
  gl::MeshPass fronts_{gl::MeshOutput::kFront};  ///< depth of blended surfaces
  gl::Program resolve_;
  gl::VertexArray empty_vao_;
  gl::RenderTarget drawn_, strip_;
  gl::RenderTarget fronts_alone_;  ///< depth of all blended surfaces, as if nothing else were there
  int samples_ = 0;                ///< of `resolve_`
};

}  // namespace mirage

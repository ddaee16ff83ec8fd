#pragma once
// Refinement: a picture at rest becomes the mean of several drawings of the same view, each moved
// by a part of a pixel.
// Input:  what the frame renderer drew last, with nothing under way that would change it.
// Output: in the target, a better picture of the same. Thread: the GL one.

#include "client/core/frame_renderer.h"
#include "shaders/gl/program.h"

namespace mirage {

class Refinement {
 public:
  /// Drawings of a picture, at most: beyond, the eye sees no difference.
  static constexpr int kDrawings = 16;

  static Result<Refinement> create();

  /// Another picture has been drawn.
  void restart() { drawings_ = 1; }
  /// Nothing would get better any more.
  bool done() const { return drawings_ >= kDrawings; }
  /// Draws the picture once more and leaves the mean of all its drawings in the target. The inputs
  /// are those of the drawing before.
  void draw_more(FrameRenderer& renderer, const FrameTarget& target, const Camera& camera,
                 const SceneView& scene, const DrawList& list, const Lighting& lighting);
  std::size_t gpu_bytes() const;

 private:
  /// A texture to draw into.
  struct Plane {
    gl::Framebuffer framebuffer;
    gl::Texture color;
  };
  static Plane make_plane(int width, int height, GLenum format);
  bool make(const FrameTarget& target);
  /// Lays what was drawn over the mean with this weight.
  void add(const FrameTarget& target, float weight);
  void fill(const gl::Texture& from);

  gl::Program program_;
  gl::VertexArray vao_;
  Plane drawing_, mean_;
  int width_ = 0, height_ = 0;
  GLenum format_ = 0;  ///< of drawing_
  int drawings_ = kDrawings;
};

}  // namespace mirage

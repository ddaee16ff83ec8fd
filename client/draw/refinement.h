#pragma once
// Refinement: a picture at rest becomes the mean of many drawings of the same view with one sample
// a pixel, each moved by a part of one. Several samples would be the mean over a pixel already, and
// the mean of such means over two.
// Input:  what the frame renderer drew last, with nothing under way that would change it.
// Output: a better picture of the same, at full scale. Thread: the GL one.

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

class Refinement {
 public:
  /// Further drawings of a picture.
  static constexpr int kDrawings = 32;

  /// Another picture has been drawn: picture() is that one, until draw_more().
  void restart() { drawings_ = 0; }
  /// Nothing would get better any more.
  bool done() const { return drawings_ >= kDrawings; }
  /// Makes its targets and program when it is first called; where the device cannot, the picture
  /// stays as it was. Draws the picture once more and leaves the mean of all its drawings in
  /// picture(). The inputs are those of the drawing before.
  void draw_more(FrameRenderer& renderer, const FrameTarget& target, const Camera& camera,
                 const SceneView& scene, const DrawList& list, const Lighting& lighting);
  /// Where the picture is: in `drawn`, until there are further drawings of it.
  const FrameTarget& picture(const FrameTarget& drawn) const {
    return drawings_ > 0 && one_sample_ ? *one_sample_ : drawn;
  }
  std::size_t gpu_bytes() const;

 private:
  /// A texture to draw into.
  struct Plane {
    gl::Framebuffer framebuffer;
    gl::Texture color;
  };
  static Plane make_plane(int width, int height, GLenum format);
  static GLenum mean_format();
  bool make(const FrameTarget& target);
  /// Lays what `drawn` shows over the mean with this weight.
  void add(const FrameTarget& drawn, float weight);
  void fill(const gl::Texture& from);

  gl::Program program_;
  gl::VertexArray vao_;
  std::optional<FrameTarget> one_sample_;
  Plane drawing_, mean_;
  int drawings_ = kDrawings;
};

}  // namespace mirage

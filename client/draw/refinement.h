#pragma once
// Refinement: a picture at rest becomes the mean of many drawings of the same view. Each drawing
// has one sample a pixel and is moved by a part of a pixel. With several samples each drawing would
// already be a mean over a pixel, and the mean of these would blur over two.
// Input:  what the frame renderer drew last, if nothing under way would change it.
// Output: a better picture of the same view, at full scale.
// Thread: the GL thread.
// Full:   never; it stops after kDrawings drawings.

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

class Refinement {
 public:
  /// Further drawings of a picture, at most.
  static constexpr int kDrawings = 32;

  /// Notes that another picture has been drawn. picture() returns that one until draw_more().
  void restart() { drawings_ = 0; }
  /// True if the picture would not get any better.
  bool done() const { return drawings_ >= kDrawings; }
  /// Draws the picture once more, and leaves the mean of all its drawings in picture(). The inputs
  /// must be those of the drawing before. The first call makes targets and program; if the device
  /// cannot, the picture stays as it was.
  void draw_more(FrameRenderer& renderer, const FrameTarget& target, const PlannedFrame& frame);
  /// Returns the target that has the picture: `drawn`, until there are further drawings of it.
  const FrameTarget& picture(const FrameTarget& drawn) const {
    return drawings_ > 0 && one_sample_ ? *one_sample_ : drawn;
  }
  const FrameTarget& picture(const FrameTarget&& drawn) const = delete;  // it would be gone
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
  /// Blends what `drawn` shows into the mean with this weight.
  void add(const FrameTarget& drawn, float weight);
  void fill(const gl::Texture& from);

  gl::Program program_;
  gl::VertexArray vao_;
  std::optional<FrameTarget> one_sample_;
  Plane drawing_, mean_;
  int drawings_ = kDrawings;
};

}  // namespace mirage

#pragma once
// The client's framebuffer: multisampled sRGB colour and depth, resolved for reading or display.

#include <cstdint>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "shaders/gl/gl_object.h"

namespace mirage {

class FrameTarget {
 public:
  /// `samples` of a pixel: 0 and 1 are one, without multisampling. `blends`: many surfaces may be
  /// laid over each other (gl::color_format, where the device can). `scale` of the drawn picture,
  /// over the shown one, which it is enlarged to: below 1 with one sample only. Error kGraphicsGl.
  static Result<FrameTarget> create(int width, int height, int samples, bool blends = false,
                                    double scale = 1);

  void bind() const;
  /// Resolves and reads RGBA8, top row first; alpha is the coverage by objects.
  std::vector<std::uint8_t> read() const;
  /// Copies the means of the samples to a framebuffer of one sample and format().
  void copy_to(const gl::Framebuffer& to) const;
  /// Of what is drawn.
  GLenum format() const { return format_; }
  /// Resolves, and the texture (sRGB, 8 bits) that has the picture then, texel for drawn pixel.
  GLuint resolved_texture() const;
  /// The same for reading, GL_READ_FRAMEBUFFER bound to it.
  void resolve() const;
  /// The camera of a picture, as it is drawn: of another size where it is enlarged.
  Camera drawn_camera(const Camera& camera) const;
  bool enlarges() const { return drawn_width_ != width_ || drawn_height_ != height_; }
  /// Of the shown picture.
  int width() const { return width_; }
  int height() const { return height_; }
  /// As it is drawn.
  int drawn_width() const { return drawn_width_; }
  int drawn_height() const { return drawn_height_; }
  /// Of a pixel, as the device has them; 0: one, and no multisampling.
  int samples() const { return samples_; }
  std::size_t gpu_bytes() const;

  bool blends() const { return blends_; }

 private:
  Result<void> make(GLenum drawn_format);
  void copy(const gl::Framebuffer& from, const gl::Framebuffer& to) const;
  gl::Framebuffer draw_;
  gl::Framebuffer averaged_;  ///< of more than 8 bits: they are averaged before they are encoded
  gl::Renderbuffer averaged_color_;
  gl::Framebuffer resolved_;
  gl::Framebuffer small_;  ///< as drawn, where that is enlarged
  gl::Renderbuffer color_, depth_;
  gl::Texture resolved_color_, small_color_;
  int width_ = 0, height_ = 0, samples_ = 0;
  int drawn_width_ = 0, drawn_height_ = 0;
  GLenum format_ = 0;
  bool blends_ = false;
};

}  // namespace mirage

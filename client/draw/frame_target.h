#pragma once
// Frame target: the client's framebuffer, with multisampled sRGB colour and depth. It is resolved
// for reading or display.

#include <cstdint>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "shaders/gl/gl_object.h"

namespace mirage {

class FrameTarget {
 public:
  /// Creates a target of `width` x `height` pixels. `samples` of a pixel: 0 and 1 mean one sample,
  /// without multisampling. `blends`: many surfaces may lie over each other (gl::color_format, if
  /// the device supports it). `scale` is the edge of the drawn picture over that of the shown one;
  /// below 1 the picture is enlarged, with one sample only. Error kGraphicsGl.
  static Result<FrameTarget> create(int width, int height, int samples, bool blends = false,
                                    double scale = 1);

  void bind() const;
  /// Resolves, and returns RGBA8 pixels, top row first; alpha is the coverage by objects.
  std::vector<std::uint8_t> read() const;
  /// Copies the means of the samples to a framebuffer with one sample and this format().
  void copy_to(const gl::Framebuffer& to) const;
  /// Returns the format of the drawn picture.
  GLenum format() const { return format_; }
  /// Resolves, and returns the texture (sRGB, 8 bits) with the picture, a texel for each drawn
  /// pixel.
  GLuint resolved_texture() const;
  /// Returns a texture with the window depth of each drawn pixel (32-bit float), of one of its
  /// samples; 0: the device has no memory for it.
  GLuint depth_texture() const;
  /// Resolves, and binds the result to GL_READ_FRAMEBUFFER.
  void resolve() const;
  /// As resolve(), but the result has a pixel for each drawn pixel.
  void resolve_drawn() const;
  /// Returns the camera at the size of the drawn picture, which differs if that is enlarged.
  Camera drawn_camera(const Camera& camera) const;
  bool enlarges() const { return drawn_width_ != width_ || drawn_height_ != height_; }
  /// Size of the shown picture, pixels.
  int width() const { return width_; }
  int height() const { return height_; }
  /// Size of the drawn picture, pixels.
  int drawn_width() const { return drawn_width_; }
  int drawn_height() const { return drawn_height_; }
  /// Returns the samples of a pixel, as the device has them; 0: one, without multisampling.
  int samples() const { return samples_; }
  std::size_t gpu_bytes() const;

  bool blends() const { return blends_; }

 private:
  Result<void> make(GLenum drawn_format);
  void copy(const gl::Framebuffer& from, const gl::Framebuffer& to) const;
  gl::Framebuffer draw_;
  gl::Framebuffer averaged_;  ///< with more than 8 bits: samples are averaged before encoding
  gl::Renderbuffer averaged_color_;
  gl::Framebuffer resolved_;
  gl::Framebuffer small_;  ///< the drawn picture, if that is enlarged
  gl::Renderbuffer color_, depth_;
  gl::Texture resolved_color_, small_color_;
  mutable gl::Framebuffer read_depth_;  ///< made when depth_texture() is first called
  mutable gl::Texture depth_texels_;
  int width_ = 0, height_ = 0, samples_ = 0;
  int drawn_width_ = 0, drawn_height_ = 0;
  GLenum format_ = 0;
  bool blends_ = false;
};

}  // namespace mirage

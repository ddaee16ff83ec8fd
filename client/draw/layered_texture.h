#pragma once
// A texture array that has only the layers that have been needed so far. GLES 3.0 subset, which
// cannot add layers to a texture: what is there is copied into a larger one by the graphics card,
// and both are there until it has been.

#include <cstdint>

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"

namespace mirage {

class LayeredTexture {
 public:
  struct Format {
    GLenum stored = GL_RGBA8;  ///< GL_SRGB8_ALPHA8, GL_RGBA8 or GL_R8
    GLint filter = GL_LINEAR;
    int channels() const { return stored == GL_R8 ? 1 : 4; }
  };
  LayeredTexture() = default;
  /// `edge` texels square, at most `max_layers` deep; none is made yet.
  LayeredTexture(Format format, int edge, int max_layers)
      : format_(format), edge_(edge), max_layers_(max_layers) {}

  /// Puts `w` x `h` texels, as many bytes each as the format has channels, at (x, y) of a layer
  /// below `max_layers`. Error kGraphicsGl: no graphics memory for so many layers.
  Result<void> upload(int layer, int x, int y, int w, int h, const std::uint8_t* texels);
  /// 0 before the first upload; another one after each that needed more layers.
  GLuint id() const { return texture_.id(); }
  int layers() const { return layers_; }
  std::size_t gpu_bytes() const { return layer_bytes() * static_cast<std::size_t>(layers_); }

 private:
  std::size_t layer_bytes() const {
    return static_cast<std::size_t>(edge_) * static_cast<std::size_t>(edge_ * format_.channels());
  }
  Result<void> grow(int layers);
  /// A new one of so many layers in place of what there is.
  Result<void> make(int layers);

  Format format_;
  int edge_ = 0, max_layers_ = 0, layers_ = 0;
  gl::Texture texture_;
};

}  // namespace mirage

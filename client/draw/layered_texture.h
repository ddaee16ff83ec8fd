#pragma once
// Layered texture: a texture array that takes in pieces. The GLES 3.0 subset cannot add layers to a
// texture. So its content is copied to a larger one when it grows; both exist until the copy is
// done.

#include <cstdint>

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"

namespace mirage {

/// When layers are made.
enum class LayerSupply {
  kByNeed,  ///< as many as were needed so far, doubled each time: takes the least memory
  /// All of them with the first upload. A driver may keep what was uploaded in the processor's
  /// memory, too. After a copy on the card it reads all of that back before the next upload. With 8
  /// layers this takes 110 ms on an NVIDIA card (decision 67).
  kAtOnce,
};
/// Returns kAtOnce for a graphics card, and kByNeed for a software renderer, where making layers
/// takes long, and for a browser, where memory is scarce.
LayerSupply usual_supply();

class LayeredTexture {
 public:
  struct Format {
    GLenum stored = GL_RGBA8;  ///< GL_SRGB8_ALPHA8, GL_RGBA8 or GL_R8
    GLint filter = GL_LINEAR;
    int channels() const { return stored == GL_R8 ? 1 : 4; }
  };
  LayeredTexture() = default;
  /// Layers are `edge` texels square, at most `max_layers` of them; none is made yet.
  LayeredTexture(Format format, int edge, int max_layers, LayerSupply supply = usual_supply())
      : format_(format), supply_(supply), edge_(edge), max_layers_(max_layers) {}

  /// Uploads `w` x `h` texels to (x, y) of a layer below `max_layers`. A texel has as many bytes as
  /// the format has channels. Error kGraphicsGl: no graphics memory for so many layers.
  Result<void> upload(int layer, int x, int y, int w, int h, const std::uint8_t* texels);
  /// Returns the texture; 0 before the first upload. It changes with each upload that needs more
  /// layers.
  GLuint id() const { return texture_.id(); }
  int layers() const { return layers_; }
  std::size_t gpu_bytes() const { return layer_bytes() * static_cast<std::size_t>(layers_); }

 private:
  std::size_t layer_bytes() const {
    return static_cast<std::size_t>(edge_) * static_cast<std::size_t>(edge_ * format_.channels());
  }
  Result<void> grow(int layers);
  /// Replaces the texture by a new one with this many layers.
  Result<void> make(int layers);

  Format format_;
  LayerSupply supply_ = LayerSupply::kByNeed;
  int edge_ = 0, max_layers_ = 0, layers_ = 0;
  gl::Texture texture_;
};

}  // namespace mirage

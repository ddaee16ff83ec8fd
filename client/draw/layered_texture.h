#pragma once
// Layered texture: a texture array with only the layers that were needed so far. The GLES 3.0
// subset cannot add layers to a texture. So the graphics card copies the content to a larger
// texture; both exist until the copy is done.
//
// Texels reach it in one of two ways (TexelWay). A driver may keep a texture that texels were
// written to in the memory of the processor, and move all of it when a layer is attached to a
// framebuffer: 110 ms for 8 layers on an NVIDIA card. A texture that only framebuffers are used
// for stays on the card.

#include <cstdint>

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"

namespace mirage {

/// How texels reach the texture.
enum class TexelWay {
  kStraight,  ///< written to the texture: quickest for a software renderer
  kBlitted,   ///< written to a small texture, and copied through framebuffers: for cards
};
/// Returns the way that suits the current context.
TexelWay usual_texel_way();

class LayeredTexture {
 public:
  struct Format {
    GLenum stored = GL_RGBA8;  ///< GL_SRGB8_ALPHA8, GL_RGBA8 or GL_R8
    GLint filter = GL_LINEAR;
    int channels() const { return stored == GL_R8 ? 1 : 4; }
  };
  LayeredTexture() = default;
  /// Layers are `edge` texels square, at most `max_layers` of them; none is made yet.
  LayeredTexture(Format format, int edge, int max_layers, TexelWay way = usual_texel_way())
      : format_(format), way_(way), edge_(edge), max_layers_(max_layers) {}

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
  /// Copies the first `layers` of another texture to this one.
  void copy_layers(const gl::Texture& from, int layers);
  /// Makes the small texture at least `edge` texels square, and binds it.
  void bind_small(int edge);

  Format format_;
  TexelWay way_ = TexelWay::kStraight;
  int edge_ = 0, max_layers_ = 0, layers_ = 0;
  gl::Texture texture_;
  gl::Texture small_;  ///< what is blitted
  int small_edge_ = 0;
  gl::Framebuffer from_, to_;  ///< made for the first copy
};

}  // namespace mirage

#pragma once
// The atlas on the graphics card: layers of colour (sRGB, premultiplied), depth code and, for relit
// tiles, surface (normal, material); each has as many as tiles have needed. GLES 3.0 subset.

#include <cstdint>
#include <vector>

#include "client/draw/layered_texture.h"
#include "client/hold/tile_cache.h"
#include "protocol/base/result.h"

namespace mirage {

/// Bytes of graphics memory a texel of the atlas takes: colour, depth code, surface.
inline constexpr int kAtlasTexelBytes = 9;

class ImpostorAtlas {
 public:
  ImpostorAtlas() = default;
  /// Edge in texels; takes no graphics memory yet. Error kGraphicsGl: more than the device can.
  static Result<ImpostorAtlas> create(int edge, int layers);

  /// Puts a tile's planes, with a gutter of nothing, where its record says. Error kGraphicsGl: no
  /// graphics memory is left; the tile shows nothing.
  Result<void> upload(const TileRecord& record, const TilePixels& pixels);
  /// Colour, depth and, for relit tiles, surface as texture units 0, 1 and 3.
  void bind(bool relit) const;
  std::size_t gpu_bytes() const {
    return color_.gpu_bytes() + depth_.gpu_bytes() + surface_.gpu_bytes();
  }

 private:
  LayeredTexture color_, depth_, surface_;
};

}  // namespace mirage

#pragma once
// The atlas on the graphics card: layers of colour (sRGB, premultiplied), depth code and, once a
// relit tile has come, surface (normal, material). GLES 3.0 subset.

#include <cstdint>
#include <vector>

#include "client/core/tile_cache.h"
#include "protocol/result.h"
#include "shaders/gl/gl_object.h"

namespace mirage {

class ImpostorAtlas {
 public:
  ImpostorAtlas() = default;
  /// Error kGraphicsGl: does not fit the graphics memory. Edge in texels.
  static Result<ImpostorAtlas> create(int edge, int layers);

  /// Puts a tile's planes, with a gutter of nothing, where its record says. The first relit one
  /// makes the surface layers, which take four fifths of what the others take on top.
  void upload(const TileRecord& record, const TilePixels& pixels);
  /// Colour, depth and, for relit tiles, surface as texture units 0, 1 and 3.
  void bind(bool relit) const;
  std::size_t gpu_bytes() const { return gpu_bytes_; }

 private:
  void upload_surface(const AtlasSlot& slot, const std::vector<std::uint8_t>& surface, int w,
                      int h);

  gl::Texture color_, depth_, surface_;
  int edge_ = 0, layers_ = 0;
  std::size_t gpu_bytes_ = 0;
};

}  // namespace mirage

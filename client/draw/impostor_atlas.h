#pragma once
// Impostor atlas: the tiles on the graphics card. It has layers of colour (sRGB, premultiplied),
// depth code and, for relit tiles, surface (normal, material). layered_texture.h
// says when layers are made. GLES 3.0 subset.

#include <cstdint>
#include <vector>

#include "client/draw/layered_texture.h"
#include "protocol/base/result.h"

namespace mirage {

struct AtlasPlanes;
struct TileRecord;

/// Bytes of graphics memory for a texel of the atlas: colour, depth code, surface.
inline constexpr int kAtlasTexelBytes = 9;

class ImpostorAtlas {
 public:
  ImpostorAtlas() = default;
  /// Creates an atlas with layers of `edge` texels square; takes no graphics memory yet. Error
  /// kGraphicsGl: more than the device supports.
  static Result<ImpostorAtlas> create(int edge, int layers);

  /// Uploads a tile's planes to the place in its record. Error kGraphicsGl: no graphics memory is
  /// left, and the tile shows nothing.
  Result<void> upload(const TileRecord& record, const AtlasPlanes& planes);
  /// Binds colour, depth and, for relit tiles, surface to the texture units 0, 1 and 3.
  void bind(bool relit) const;
  std::size_t gpu_bytes() const {
    return color_.gpu_bytes() + depth_.gpu_bytes() + surface_.gpu_bytes();
  }

 private:
  LayeredTexture color_, depth_, surface_;
};

}  // namespace mirage

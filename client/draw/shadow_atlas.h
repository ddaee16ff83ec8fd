#pragma once
// Shadow atlas: the shadow and caster tiles on the graphics card, with one channel. GLES 3.0
// subset.

#include <cstdint>
#include <vector>

#include "client/draw/layered_texture.h"
#include "client/hold/shadow_cache.h"

namespace mirage {

class ShadowAtlas {
 public:
  /// Uploads a tile to the place in its record: AtlasPlanes::depth of a caster, or
  /// AtlasPlanes::shadow. Error kGraphicsGl.
  Result<void> upload(const ShadowRecord& record, const std::vector<std::uint8_t>& plane);
  /// Returns the texture; 0 before the first tile.
  GLuint texture() const { return layers_.id(); }
  std::size_t gpu_bytes() const { return layers_.gpu_bytes(); }

 private:
  LayeredTexture layers_{{GL_R8, GL_LINEAR}, kShadowAtlasEdge, kShadowAtlasLayers};
};

}  // namespace mirage

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
  /// Upload a tile's plane to the place in its record. A caster's plane has depth codes. A shadow
  /// tile's has shares as 0..1, which are continued into the empty texels around them. Error
  /// kGraphicsGl.
  Result<void> upload_caster(const ShadowRecord& record, const std::vector<std::uint8_t>& codes);
  Result<void> upload_shadow(const ShadowRecord& record, const std::vector<std::uint8_t>& shares);
  /// Returns the texture; 0 before the first tile.
  GLuint texture() const { return layers_.id(); }
  std::size_t gpu_bytes() const { return layers_.gpu_bytes(); }

 private:
  Result<void> upload(const AtlasSlot& slot, const std::vector<std::uint8_t>& texels);

  LayeredTexture layers_{{GL_R8, GL_LINEAR}, kShadowAtlasEdge, kShadowAtlasLayers};
};

}  // namespace mirage

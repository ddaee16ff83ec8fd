#pragma once
// The atlas of shadow and caster tiles on the graphics card: one channel. GLES 3.0 subset.

#include <cstdint>
#include <vector>

#include "client/core/shadow_cache.h"
#include "shaders/gl/gl_object.h"

namespace mirage {

class ShadowAtlas {
 public:
  /// Puts a tile's plane where its record says: a caster's depth codes, or a shadow tile's shares
  /// as 0..1, continued into what is empty around them. The first one makes the layers.
  void upload_caster(const ShadowRecord& record, const std::vector<std::uint8_t>& codes);
  void upload_shadow(const ShadowRecord& record, const std::vector<std::uint8_t>& shares);
  GLuint texture() const { return layers_.id(); }
  std::size_t gpu_bytes() const;

 private:
  void upload(const AtlasSlot& slot, const std::vector<std::uint8_t>& texels);

  gl::Texture layers_;
};

}  // namespace mirage

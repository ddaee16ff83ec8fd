#include "client/draw/impostor_atlas.h"

#include "client/hold/tile_cache.h"
#include "protocol/codec/atlas_planes.h"

namespace mirage {

Result<ImpostorAtlas> ImpostorAtlas::create(int edge, int layers) {
  GLint most_layers = 0, longest = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &longest);
  if (layers > most_layers || edge > longest) {
    return make_error(ErrorId::kGraphicsGl, "the atlas has more layers than the device can",
                      "--atlas-mb takes less");
  }
  ImpostorAtlas atlas;
  atlas.color_ = LayeredTexture({GL_SRGB8_ALPHA8, GL_LINEAR}, edge, layers);
  atlas.depth_ = LayeredTexture({GL_R8, GL_NEAREST}, edge, layers);
  atlas.surface_ = LayeredTexture({GL_RGBA8, GL_LINEAR}, edge, layers);
  return atlas;
}

Result<void> ImpostorAtlas::upload(const TileRecord& record, const AtlasPlanes& planes) {
  const auto put = [&](LayeredTexture& texture, const AtlasSlot& slot,
                       const std::vector<std::uint8_t>& texels) -> Result<void> {
    if (texels.empty()) return {};
    return texture.upload(slot.layer, slot.x, slot.y, static_cast<int>(record.crop.w) + 2,
                          static_cast<int>(record.crop.h) + 2, texels.data());
  };
  Result<void> done = put(color_, record.slot, planes.color);
  if (done) done = put(depth_, record.slot, planes.depth);
  if (done) done = put(color_, record.front_slot, planes.front_color);
  if (done) done = put(depth_, record.front_slot, planes.front_depth);
  if (done) done = put(color_, record.behind_slot, planes.behind_color);
  if (done) done = put(depth_, record.behind_slot, planes.behind_depth);
  if (done) done = put(surface_, record.slot, planes.surface);
  return done;
}

void ImpostorAtlas::bind(bool relit) const {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, color_.id());
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D_ARRAY, depth_.id());
  if (!relit) return;
  glActiveTexture(GL_TEXTURE3);
  glBindTexture(GL_TEXTURE_2D_ARRAY, surface_.id());
}

}  // namespace mirage

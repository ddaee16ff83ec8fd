#include "client/draw/shadow_atlas.h"

namespace mirage {

Result<void> ShadowAtlas::upload(const ShadowRecord& record,
                                 const std::vector<std::uint8_t>& plane) {
  if (plane.empty()) return {};
  const AtlasSlot& slot = record.slot;
  return layers_.upload(slot.layer, slot.x, slot.y, slot.w, slot.h, plane.data());
}

}  // namespace mirage

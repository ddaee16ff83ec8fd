#pragma once
// Materials in a fixed layout without padding; lobes and anisotropy follow those that have any.

#include "protocol/base/byte_stream.h"
#include "protocol/model/model.h"

namespace mirage {

inline constexpr std::size_t kTextureBytes = 4 + 4 + 5 * 4;
/// Without lobes, which is the least a material takes.
inline constexpr std::size_t kMaterialBytes = 4 * 4 + 3 * 4 + 5 * 4 + 4 + 5 * kTextureBytes;

void put_material(ByteWriter& w, const Material& m);
/// False when a value is out of range, not finite, or an image not one of `images`.
bool get_material(ByteReader& r, Material& m, std::size_t images);

}  // namespace mirage

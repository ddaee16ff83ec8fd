#pragma once
// Materials in a fixed layout without padding. Lobes and anisotropy follow where a material has
// them.

#include "protocol/base/byte_stream.h"
#include "protocol/model/model.h"

namespace mirage {

inline constexpr std::size_t kTextureBytes = 4 + 4 + 5 * 4;
/// Bytes of a material without lobes, the smallest.
inline constexpr std::size_t kMaterialBytes = 4 * 4 + 3 * 4 + 5 * 4 + 4 + 5 * kTextureBytes;

void put_material(ByteWriter& w, const Material& m);
/// Reads a material; false if a value is out of range or not finite, or an image is not below
/// `images`.
bool get_material(ByteReader& r, Material& m, std::size_t images);

}  // namespace mirage

#pragma once
// Bytes of an object's animation, behind those of its mesh (model_codec.h).

#include <memory>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/model/animation.h"

namespace mirage {

/// Raw little-endian bytes; one zero byte for an object without animation.
Bytes encode_animation(const Animation* animation);
std::size_t encoded_animation_bytes(const Animation* animation);

/// Reads what encode_animation() wrote, all of it; null for an object without animation. Every
/// count is held against the bytes that are left and limits.h before it is allocated, every index
/// against its list (`mesh_vertices` vertices), every number for being finite, every list of times
/// for rising. Errors: kWireMalformed, kWireLimit, kWireValue.
Result<std::shared_ptr<const Animation>> decode_animation(const std::uint8_t* bytes,
                                                          std::size_t size,
                                                          std::size_t mesh_vertices);

}  // namespace mirage

#pragma once
// Bytes of an object's animation; they follow those of its mesh (model_codec.h).

#include <memory>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/model/animation.h"

namespace mirage {

/// Returns raw little-endian bytes; one zero byte for an object without animation.
Bytes encode_animation(const Animation* animation);
std::size_t encoded_animation_bytes(const Animation* animation);

/// Decodes all bytes that encode_animation() wrote; null for an object without animation. Every
/// count is checked against the bytes left and limits.h before anything is allocated. Every index
/// must be inside its list (`mesh_vertices` vertices), every number finite, and every list of times
/// rising. Errors: kWireMalformed, kWireLimit, kWireValue.
Result<std::shared_ptr<const Animation>> decode_animation(const std::uint8_t* bytes,
                                                          std::size_t size,
                                                          std::size_t mesh_vertices);

}  // namespace mirage

#pragma once
// Encoded PNG, JPEG or WebP bytes -> RGBA8, through OpenImageIO and from memory.

#include <cstdint>
#include <span>
#include <string>

#include "protocol/model.h"
#include "protocol/result.h"

namespace mirage::gltf {

/// Alpha stays unassociated, 16-bit is reduced, grey and RGB are expanded. `srgb` is left to the
/// caller. `max_pixels` bounds what is allocated; sizes are judged before any pixel is decoded.
/// Errors: kSceneFormat (unreadable), kSceneLimit (too large).
Result<Image> decode_image(std::span<const std::uint8_t> bytes, std::uint64_t max_pixels);

}  // namespace mirage::gltf

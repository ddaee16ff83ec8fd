#pragma once
// Encoded PNG, JPEG or WebP bytes -> RGBA8, through OpenImageIO and from memory.

#include <cstdint>
#include <span>
#include <string>

#include "protocol/model.h"
#include "protocol/result.h"

namespace mirage::gltf {

/// Width times height, as the first bytes tell. Errors: kSceneFormat (none of the three formats,
/// or empty), kSceneLimit (more than `max_pixels`, or a side beyond kMaxImageSide).
Result<std::uint64_t> count_pixels(std::span<const std::uint8_t> bytes, std::uint64_t max_pixels);

/// Alpha stays unassociated, 16-bit is reduced, grey and RGB are expanded. `srgb` is left to the
/// caller. `max_pixels` bounds what is allocated: count_pixels() judges before any is decoded.
/// Errors: those, and kSceneFormat (unreadable). Any thread.
Result<Image> decode_image(std::span<const std::uint8_t> bytes, std::uint64_t max_pixels);

}  // namespace mirage::gltf

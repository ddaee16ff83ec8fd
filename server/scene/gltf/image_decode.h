#pragma once
// Decodes PNG, JPEG, WebP or KTX2 bytes into RGBA8, through the libraries of modules and from
// memory.

#include <cstdint>
#include <span>
#include <string>

#include "protocol/base/result.h"
#include "protocol/model/model.h"
#include "server/scene/gltf/image_size.h"

namespace mirage::gltf {

struct SceneLimits;

/// Returns format and size from the first bytes. Errors: kSceneFormat (none of the four formats,
/// or empty), kSceneLimit (a side beyond kMaxImageSide, or more pixels than `limits` allow in a
/// form that decoders hold as a whole).
Result<ImageHeader> judge_image(std::span<const std::uint8_t> bytes, const SceneLimits& limits);

/// Decodes an image. Alpha stays unassociated, 16-bit is reduced, grey and RGB are expanded. The
/// sides are halved `halvings` times (image_reduce.h); if `srgb`, the colours are averaged as
/// linear light. Errors: kSceneFormat (unreadable), kModule (no library for it), kResources. Any
/// thread.
Result<Image> decode_image(std::span<const std::uint8_t> bytes, int halvings, bool srgb);

}  // namespace mirage::gltf

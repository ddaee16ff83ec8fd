#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "server/bake/bake_options.h"
#include "server/bake/export.h"

namespace mirage {

/// Returns the name of an image with the ending of a format.
std::string with_ending(const std::string& file, BakeFormat format);
/// Returns the bytes of an image's file. Errors kModule, kIo.
Result<std::vector<std::uint8_t>> image_bytes(const BakeImage& image, BakeFormat format);

}  // namespace mirage

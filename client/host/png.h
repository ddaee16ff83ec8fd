#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// Writes sRGB RGBA pixels (top row first) as an opaque PNG. Error kIo.
Result<void> write_png(const std::string& path, int width, int height,
                       const std::vector<std::uint8_t>& rgba);

}  // namespace mirage

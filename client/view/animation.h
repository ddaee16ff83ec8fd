#pragma once
// Frames as one moving picture, for looking at in a browser.

#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// Writes the images, all of one size, as an animated WebP that repeats. Errors: kIo, kUsage (sizes
/// that differ, none at all).
Result<void> write_animation(const std::vector<std::string>& images, double frames_per_second,
                             const std::string& target);

}  // namespace mirage

#pragma once
// Animation: writes frames as one moving picture that a browser can show.

#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// Writes the images as an animated WebP that repeats. All images have one size. Errors: kIo,
/// kUsage (sizes differ, or no image).
Result<void> write_animation(const std::vector<std::string>& images, double frames_per_second,
                             const std::string& target);

}  // namespace mirage

#pragma once
// Encodes texels as the channels of a target's files, and says in words how.

#include <string>
#include <string_view>

#include "server/bake/frame_texels.h"

namespace mirage {

/// Returns one channel of a texel, 0 to 1, linear. `basis`: of the texel's frame.
float encode(MapChannel channel, const FrameTexel& texel, const TargetFacts& target,
             const FrameBasis& basis);
/// Returns the sRGB curve of a linear value (IEC 61966-2-1).
float srgb_of(float linear);
/// Returns the formula of a channel, such as "n.x * .5 + .5".
std::string_view formula_of(MapChannel channel);
bool is_color(MapChannel channel);

}  // namespace mirage

#pragma once
// Mip levels of an image, made on the CPU because the driver's are not good enough.

#include <vector>

#include "protocol/model/model.h"

namespace mirage {

/// Returns levels 1 … of `image` (level 0 is the image itself), box-filtered in linear light with
/// colour weighted by alpha. With `cutoff` in (0, 1), each level's alpha is scaled so that the
/// share of texels at or above the cutoff stays that of level 0: foliage keeps its density at a
/// distance (I. Castaño, "Computing alpha mipmaps", 2010).
std::vector<Image> alpha_preserving_mips(const Image& image, float cutoff);

/// Returns `image` box-filtered to `size` (each side at most the image's) in the same way: in
/// linear light, with colour weighted by alpha, and coverage kept if `cutoff` is above 0.
Image reduced_image(const Image& image, const glm::uvec2& size, float cutoff);

}  // namespace mirage

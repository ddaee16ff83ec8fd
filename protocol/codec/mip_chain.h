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

/// Returns `image` box-filtered in linear light to `size` (each side at most the image's). With a
/// cutoff above 0, colour is weighted by alpha and coverage kept, as above. Otherwise each channel
/// is averaged on its own, as a driver does for the mips of a full image: alpha may then hold
/// anything, and both ends must show the same.
Image reduced_image(const Image& image, const glm::uvec2& size, float cutoff);

}  // namespace mirage

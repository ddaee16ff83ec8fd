#pragma once
// Distances inside one frame of a bake: which covered texel is nearest, and how far an outline is.
// A frame is a square of texels, row by row. All functions are exact and take linear time.
// Method: Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, 2012.

#include <cstdint>
#include <vector>

namespace mirage {

/// A frame's texels that are chosen: 1, others: 0.
using TexelMask = std::vector<std::uint8_t>;

struct NearestTexels {
  std::vector<int> texel;       ///< number of the nearest chosen texel; -1 if none is chosen
  std::vector<float> distance;  ///< to it, between centres, in texels; infinite if none is chosen
};

/// Returns the nearest chosen texel of each texel. `size`: texels a side.
NearestTexels nearest_texels(const TexelMask& chosen, int size);

/// Returns a field that is 0 outside and grows inside with the distance d to the nearest texel
/// outside: min(d / reach, 1). `reach` in texels.
std::vector<float> inner_field(const TexelMask& inside, int size, float reach);

/// Returns a field that is .5 halfway between the last texel inside and the first outside, 1 at
/// `reach` texels inside and 0 at `reach` texels outside: (+-(d - .5) / (reach - .5) + 1) / 2,
/// where d is the distance to the nearest texel of the other kind.
std::vector<float> signed_field(const TexelMask& inside, int size, float reach);

}  // namespace mirage

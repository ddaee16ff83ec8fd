#pragma once
// A .boimp file: a zip without compression that holds settings.txt and the texels of a bake, eight
// bytes each (two words of 32 bits, little-endian, in the four channels of two PNG pixels).
//
//   word  bits    content
//     0   0-4     red, linear and straight
//     0   5-9     green
//     0   10-14   blue
//     0   15-19   coverage
//     0   20-23   roughness
//     0   24-27   metallic
//     0   28-31   flags: 1 unlit, 2 emissive
//     1   0-11    normal, whole octahedron around +y: x
//     1   12-23   normal: z
//     1   24-31   depth, .5 + s / 2r
// A texel with less than half coverage has two words of 0.
//
// settings.txt: "grid radius mode tile x y width height". The last four are the part of each frame
// that the file holds, from the top left. Texels are either in texture.png, or each different one
// is in pixels.png and indices.png has their numbers: two to a pixel if there are fewer than
// 65,536, otherwise one.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "server/bake/frame_texels.h"

namespace mirage {

using BoimpTexel = std::array<std::uint32_t, 2>;
BoimpTexel boimp_texel(const FrameTexel& texel);
/// Returns the names of the fields above, word by word.
std::vector<std::string> boimp_channels();

/// Returns the bytes of the file; equal bakes give equal bytes. Errors kModule, kIo: the pictures
/// could not be made; kUsage: they are too large.
Result<std::vector<std::uint8_t>> boimp_file(const BakeMaster& master, const TargetFacts& target);

}  // namespace mirage

#pragma once
// Variants of the mesh shader: the bits that choose one, and their names in GLSL. Only MeshPass
// uses them.

#include <cstddef>
#include <string>
#include <vector>

#include "protocol/model/need_mask.h"

namespace mirage::gl {

// Bits for properties of the frame, beyond the need bits of objects in need_mask.h.
inline constexpr NeedMask kFog = NeedMask{1} << 63;
inline constexpr NeedMask kFade = NeedMask{1} << 62;
inline constexpr NeedMask kDepthOnly = NeedMask{1} << 61;
inline constexpr NeedMask kShadow = NeedMask{1} << 60;
inline constexpr NeedMask kSwitches = NeedMask{1} << 59;  ///< of forced features
inline constexpr NeedMask kProbe = NeedMask{1} << 58;

/// Bits of need_mask.h that the shader knows, and those of a variant that only writes depth.
inline constexpr NeedMask kShaderNeeds = kLobeNeeds | kLobeMapNeeds | kNeedLighting |
                                         kNeedBaseColorMap | kNeedMetalRoughMap | kNeedNormalMap |
                                         kNeedOcclusionMap | kNeedEmissiveMap | kNeedAlphaMask |
                                         kNeedBlend | kNeedVertexColor;
inline constexpr NeedMask kDepthNeeds = kNeedBaseColorMap | kNeedAlphaMask | kNeedVertexColor;

/// Returns the need of a lobe map, by its number in LobeMap.
constexpr NeedMask lobe_map_need(std::size_t i) { return NeedMask{kNeedFirstLobeMap} << i; }
/// Returns its sampler in mesh.frag.
const char* lobe_map_sampler(std::size_t i);

/// Returns the defines of a variant.
std::vector<std::string> variant_defines(NeedMask needs);

}  // namespace mirage::gl

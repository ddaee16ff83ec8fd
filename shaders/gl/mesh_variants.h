#pragma once
// Variants of the mesh shader: which bits choose one, and the names these have in GLSL. Of MeshPass
// alone.

#include <cstddef>
#include <string>
#include <vector>

#include "protocol/model/need_mask.h"

namespace mirage::gl {

// No need of an object: a property of the frame, beyond the bits of need_mask.h.
inline constexpr NeedMask kFog = NeedMask{1} << 63;
inline constexpr NeedMask kFade = NeedMask{1} << 62;
inline constexpr NeedMask kDepthOnly = NeedMask{1} << 61;
inline constexpr NeedMask kShadow = NeedMask{1} << 60;
inline constexpr NeedMask kSwitches = NeedMask{1} << 59;  ///< of what is forced
inline constexpr NeedMask kProbe = NeedMask{1} << 58;

/// Bits of need_mask.h that the shader knows of, and those of a variant that writes depth alone.
inline constexpr NeedMask kShaderNeeds = kLobeNeeds | kLobeMapNeeds | kNeedLighting |
                                         kNeedBaseColorMap | kNeedMetalRoughMap | kNeedNormalMap |
                                         kNeedOcclusionMap | kNeedEmissiveMap | kNeedAlphaMask |
                                         kNeedBlend | kNeedVertexColor;
inline constexpr NeedMask kDepthNeeds = kNeedBaseColorMap | kNeedAlphaMask | kNeedVertexColor;

/// The need of a map of lobes, by its number in LobeMap.
constexpr NeedMask lobe_map_need(std::size_t i) { return NeedMask{kNeedFirstLobeMap} << i; }
/// Its sampler in mesh.frag.
const char* lobe_map_sampler(std::size_t i);

/// What is defined for a variant.
std::vector<std::string> variant_defines(NeedMask needs);

}  // namespace mirage::gl

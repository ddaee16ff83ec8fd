#pragma once
// Need mask: the features an object needs drawn, one bit each. It selects shader variants on both
// ends. A clear bit means that the feature is absent or provably neutral (numerics.md section 5).

#include <cstdint>
#include <vector>

#include "protocol/model/model.h"

namespace mirage {

using NeedMask = std::uint64_t;

enum Need : NeedMask {
  kNeedLighting = 1u << 0,
  kNeedBaseColorMap = 1u << 1,
  kNeedMetalRoughMap = 1u << 2,
  kNeedNormalMap = 1u << 3,
  kNeedOcclusionMap = 1u << 4,
  kNeedEmissiveMap = 1u << 5,
  kNeedAlphaMask = 1u << 6,
  kNeedBlend = 1u << 7,
  kNeedVertexColor = 1u << 8,
  kNeedSpecular = 1u << 9,
  kNeedTextureTransform = 1u << 10,
  kNeedUv1 = 1u << 11,
  kNeedEmissive = 1u << 12,
  kNeedUnlit = 1u << 13,
  kNeedShadowPass = 1u << 14,  ///< some part is not blended, so it blocks sunlight
  // Lobes beyond metal-rough, and their maps in the order of LobeMap.
  kNeedReflectance = 1u << 15,  ///< KHR_materials_specular, KHR_materials_ior
  kNeedClearcoat = 1u << 16,
  kNeedSheen = 1u << 17,
  kNeedTransmission = 1u << 18,
  kNeedFirstLobeMap = 1u << 19,
  /// placed after the maps, because masks travel and older bits keep their values
  kNeedAnisotropy = 1u << 27,
};
static_assert(NeedMask{kNeedFirstLobeMap} << kLobeMaps <= kNeedAnisotropy);
inline constexpr NeedMask kLobeMapNeeds = ((NeedMask{1} << kLobeMaps) - 1) * kNeedFirstLobeMap;
inline constexpr NeedMask kLobeNeeds =
    kNeedReflectance | kNeedClearcoat | kNeedSheen | kNeedTransmission | kNeedAnisotropy;

/// True if the client can shade tiles of the object: one opaque, lit surface per texel that emits
/// no light and has no lobe beyond what a tile stores.
inline bool can_relight(NeedMask needs) {
  return (needs & kNeedLighting) &&
         !(needs & (kNeedBlend | kNeedEmissive | kNeedUnlit | kLobeNeeds));
}

/// True if an object also has layered tiles: foliage, which hides much of itself. Blended objects
/// are excluded, as they show more than one surface in front anyway.
inline bool layered(NeedMask needs) { return (needs & kNeedAlphaMask) && !(needs & kNeedBlend); }

/// Returns the lobe that a map belongs to.
NeedMask lobe_of(LobeMap map);
/// Returns the needs of one material on a mesh; `vertex_color`: some vertex colour is not white.
NeedMask material_needs(const Material& material, bool vertex_color);
/// True if any vertex of the mesh has a colour other than opaque white.
bool has_vertex_color(const Mesh& mesh);
/// Returns the alpha, in the image's own scale, below which the alpha-tested material with `image`
/// as its colour shows nothing; 0: no such material uses it.
float alpha_test_cutoff(std::int32_t image, const std::vector<Material>& materials);
/// Returns the union over the object's primitives.
NeedMask object_needs(const Mesh& mesh, const std::vector<Material>& materials);

}  // namespace mirage
